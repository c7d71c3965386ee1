/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The catalog of the plugins' voices, and lookup in it. */
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/voice/voice_pool_internal.h"
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bounds the quadratic check for duplicates, in case of a malicious plugin. */
enum { PLUGIN_VOICES_MAX = 10000 };

/* Strings and outgrown lists, kept until the end because voices point to them. */
struct catalog_block {
    struct catalog_block *next;
    void *data;
    size_t size; /* of a list; 0 = a string */
};

static void *keep(struct catalog *catalog, void *data) {
    struct catalog_block *block = mem_alloc(sizeof *block);
    *block = (struct catalog_block){.next = catalog->blocks, .data = data};
    catalog->blocks = block;
    return data;
}

/* Limits for strings from a plugin, in bytes. */
enum { TEXT_MAX = 256, LANG_MAX = 35 };

/* Strings that are too long become "". */
static const char *keep_text(struct catalog *catalog, const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return keep(catalog, mem_strdup(text && strlen(text) <= TEXT_MAX ? text : ""));
}

static const struct voice *by_id(struct voice_list list, const char *id) {
    for (size_t i = 0; i < list.count; i++)
        if (!strcmp(list.voices[i].id, id))
            return &list.voices[i];
    return NULL;
}

struct voice_list catalog_list(const struct catalog *catalog) {
    return (struct voice_list){catalog->voices, catalog->count};
}

static void add(struct catalog *catalog, const char *plugin, uint32_t capabilities, const json_t *object) {
    const char *id = json_string_value(json_object_get(object, "id"));
    const char *lang = json_string_value(json_object_get(object, "lang"));
    char full[128];
    size_t bad;
    if (!id || !lang || strlen(lang) > LANG_MAX || !lang_is_tag(lang, strlen(lang), &bad) || !*id ||
        (size_t)snprintf(full, sizeof full, "%s:%s", plugin, id) >= sizeof full ||
        by_id(catalog_list(catalog), full))
        return;
    json_int_t sample_rate = json_integer_value(json_object_get(object, "sample_rate"));
    json_int_t rate = json_integer_value(json_object_get(object, "rate"));
    catalog->voices[catalog->count++] = (struct voice){
        .id = keep(catalog, mem_strdup(full)),
        .plugin = plugin,
        .name = keep_text(catalog, object, "name"),
        .lang = keep_text(catalog, object, "lang"),
        .gender = keep_text(catalog, object, "gender"),
        .quality = keep_text(catalog, object, "quality"),
        .licence = keep_text(catalog, object, "licence"),
        .sample_rate = sample_rate >= ASSEMBLY_RATE_MIN && sample_rate <= ASSEMBLY_RATE_MAX
                           ? (uint32_t)sample_rate
                           : 22050,
        .rate = rate > 0 && rate < 2000 ? (uint32_t)rate : 170,
        .capabilities = capabilities,
    };
}

/* Voices are sorted by plugin name, whatever the order of start, and keep their order within a plugin. */
int catalog_add(struct catalog *catalog, const char *plugin, const char *description, struct error *e) {
    json_error_t why;
    json_t *root = json_loads(description, 0, &why), *voices = json_object_get(root, "voices"), *voice;
    size_t i, before = 0, added = json_array_size(voices), total = catalog->count;
    if (!added || added > PLUGIN_VOICES_MAX) {
        json_decref(root);
        return error_set(e, ERROR_BAD_VOICE_LIST, added ? "has more than %d voices" : "has no voices",
                         PLUGIN_VOICES_MAX);
    }
    while (before < total && strcmp(catalog->voices[before].plugin, plugin) <= 0)
        before++;
    const struct voice *shorter = catalog->voices;
    struct voice *longer = mem_alloc((total + added) * sizeof *longer);
    if (before)
        memcpy(longer, shorter, before * sizeof *longer);
    catalog->voices = keep(catalog, longer);
    catalog->count = before;
    uint32_t capabilities = (uint32_t)json_integer_value(json_object_get(root, "capabilities"));
    json_array_foreach(voices, i, voice) add(catalog, plugin, capabilities, voice);
    json_decref(root);
    if (before < total)
        memcpy(longer + catalog->count, shorter + before, (total - before) * sizeof *longer);
    catalog->count += total - before;
    return 0;
}

/* Replaces the list, reusing an identical earlier one, so that voices that come and go do not leak memory. */
static void become(struct catalog *catalog, struct voice *voices, size_t count) {
    size_t size = count * sizeof *voices;
    struct catalog_block *block = catalog->blocks;
    catalog->count = count;
    while (block && (!size || block->size != size || memcmp(block->data, voices, size) != 0))
        block = block->next;
    if (block) {
        free(voices);
        catalog->voices = block->data;
        return;
    }
    catalog->voices = keep(catalog, voices);
    catalog->blocks->size = size;
}

struct voice_list catalog_of_plugin(struct catalog *catalog, const char *plugin) {
    struct voice *voices = mem_alloc((catalog->count + 1) * sizeof *voices);
    size_t count = 0;
    for (size_t i = 0; i < catalog->count; i++)
        if (catalog->voices[i].plugin == plugin)
            voices[count++] = catalog->voices[i];
    return (struct voice_list){keep(catalog, voices), count};
}

void catalog_restore(struct catalog *catalog, struct voice_list removed) {
    const struct voice *before = catalog->voices;
    size_t total = catalog->count, at = 0, count = 0;
    struct voice *voices = mem_alloc((total + removed.count + 1) * sizeof *voices);
    while (at < total && removed.count && strcmp(before[at].plugin, removed.voices->plugin) <= 0)
        voices[count++] = before[at++];
    for (size_t i = 0; i < removed.count; i++)
        if (!by_id(catalog_list(catalog), removed.voices[i].id))
            voices[count++] = removed.voices[i];
    while (at < total)
        voices[count++] = before[at++];
    become(catalog, voices, count);
}

void catalog_drop(struct catalog *catalog, const char *plugin) {
    const struct voice *before = catalog->voices;
    struct voice *voices = mem_alloc((catalog->count + 1) * sizeof *voices);
    size_t count = 0;
    for (size_t i = 0; i < catalog->count; i++)
        if (before[i].plugin != plugin)
            voices[count++] = before[i];
    become(catalog, voices, count);
}

void catalog_free(struct catalog *catalog) {
    for (struct catalog_block *block = catalog->blocks, *next; block; block = next) {
        next = block->next;
        free(block->data);
        free(block);
    }
    *catalog = (struct catalog){0};
}

const struct voice *voice_pool_voices(const struct voice_pool *pool, size_t *count) {
    *count = pool->catalog.count;
    return pool->catalog.voices;
}

const struct voice *voice_by_name(struct voice_list list, const char *name) {
    const struct voice *voice = by_id(list, name);
    for (size_t i = 0; i < list.count && !voice; i++)
        if (!strcmp(list.voices[i].id + strlen(list.voices[i].plugin) + 1, name))
            voice = &list.voices[i];
    return voice;
}

/* Suggests names with or without the plugin, as in the request. */
void voice_unknown(struct voice_list list, const char *name, struct error *e) {
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (size_t i = 0; i < list.count; i++) {
        const struct voice *voice = &list.voices[i];
        suggest_name(&near, voice->id, voice->id);
        suggest_name(&near, voice->id + strlen(voice->plugin) + 1, voice->id);
    }
    error_in_field(e, ERROR_UNKNOWN_VOICE, "voice", "there is no voice \"%.80s\"%s", name,
                   suggestions_text(&near, text));
}

const struct voice *voice_pool_find(const struct voice_pool *pool, const char *name, const char *lang,
                                    const char *const *preferred, struct error *e) {
    const struct catalog *catalog = &pool->catalog;
    const struct voice *best = NULL;
    int best_fit = 0;
    if (!catalog->count) {
        error_set(e, ERROR_VOICE_UNAVAILABLE, "no voice plugin runs");
        return NULL;
    }
    if (name) {
        best = voice_by_name(catalog_list(catalog), name);
        if (!best)
            voice_unknown(catalog_list(catalog), name, e);
        return best;
    }
    for (; preferred && *preferred && !best; preferred++)
        best = voice_by_name(catalog_list(catalog), *preferred);
    if (best)
        return best;
    for (size_t i = 0; i < catalog->count && lang; i++) {
        int f = lang_fit(catalog->voices[i].lang, lang);
        if (f > best_fit) {
            best_fit = f;
            best = &catalog->voices[i];
        }
    }
    if (!best)
        error_in_field(e, ERROR_UNKNOWN_LANGUAGE, "lang", "no voice speaks \"%.80s\"", lang ? lang : "");
    return best;
}
