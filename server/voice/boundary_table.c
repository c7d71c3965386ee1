/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/boundary_table.h"
#include "server/base/json_place.h"
#include "server/base/mem.h"
#include "server/voice/boundary_table_internal.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct boundary_table {
    json_t *root; /* owns the texts */
    struct voice_boundaries *voices;
    size_t count;
};

/* The letters of the sound that stands there by its name. */
static int read_sound(const struct json_place *at, const struct json_place *sounds, const char **out) {
    const char *name;
    if (json_place_text(at, &name))
        return -1;
    struct json_place sound = json_place_key(sounds, name);
    *out = json_string_value(sound.json);
    return sound.json ? 0 : json_place_fail(at, "there is no sound '%.80s'", name);
}

static int read_rule(const struct json_place *at, const struct json_place *sounds,
                     struct boundary_rule *out) {
    static const char *const keys[] = {"before", "after", "ms", NULL};
    struct json_place before = json_place_key(at, "before"), after = json_place_key(at, "after"),
                      ms = json_place_key(at, "ms");
    double value;
    if (json_place_keys(at, keys) || read_sound(&before, sounds, &out->before) ||
        read_sound(&after, sounds, &out->after) ||
        json_place_real(&ms, -BOUNDARY_MS_MAX, BOUNDARY_MS_MAX, &value))
        return -1;
    out->seconds = value / 1000;
    return 0;
}

static int read_voice(const struct json_place *at, const struct json_place *sounds,
                      struct voice_boundaries *out) {
    if (json_place_array(at))
        return -1;
    size_t count = json_array_size(at->json);
    out->rules = mem_alloc((count + 1) * sizeof *out->rules);
    for (size_t i = 0; i < count; i++) {
        struct json_place item = json_place_item(at, i);
        if (read_rule(&item, sounds, &out->rules[out->count++]))
            return -1;
    }
    return 0;
}

static int read_sounds(const struct json_place *at) {
    const char *name, *letters;
    json_t *value;
    if (json_place_object(at))
        return -1;
    json_object_foreach(at->json, name, value) {
        struct json_place sound = json_place_key(at, name);
        if (json_place_text(&sound, &letters))
            return -1;
    }
    return 0;
}

static int read_table(const struct json_place *root, struct boundary_table *table) {
    static const char *const keys[] = {"sounds", "voices", NULL};
    struct json_place sounds = json_place_key(root, "sounds"), voices = json_place_key(root, "voices");
    const char *name;
    json_t *value;
    if (json_place_keys(root, keys) || read_sounds(&sounds) || json_place_object(&voices))
        return -1;
    table->voices = mem_alloc((json_object_size(voices.json) + 1) * sizeof *table->voices);
    json_object_foreach(voices.json, name, value) {
        struct json_place voice = json_place_key(&voices, name);
        table->voices[table->count].voice = name;
        if (read_voice(&voice, &sounds, &table->voices[table->count++]))
            return -1;
    }
    return 0;
}

struct boundary_table *boundary_table_load(const char *path, struct error *e) {
    struct boundary_table *table = mem_alloc(sizeof *table);
    struct json_place root;
    if (access(path, F_OK))
        return table;
    int failed = json_place_load(path, ERROR_BAD_BOUNDARIES, &root, e);
    if (!failed) {
        table->root = root.json;
        failed = read_table(&root, table);
    }
    if (!failed)
        return table;
    boundary_table_free(table);
    return NULL;
}

void boundary_table_free(struct boundary_table *table) {
    if (!table)
        return;
    for (size_t i = 0; i < table->count; i++)
        free(table->voices[i].rules);
    free(table->voices);
    json_decref(table->root);
    free(table);
}

const struct voice_boundaries *boundary_table_find(const struct boundary_table *table, const char *voice) {
    for (size_t i = 0; table && i < table->count; i++)
        if (!strcmp(table->voices[i].voice, voice))
            return &table->voices[i];
    return NULL;
}
