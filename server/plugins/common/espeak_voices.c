/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/common/espeak_voices.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <espeak-ng/speak_lib.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* espeak-ng writes tags in lower case; BCP 47 (RFC 5646, 2.1.1) wants Latn and BR, but no change after an
 * "x". */
static void write_tag(char *out, size_t cap, const char *tag) {
    snprintf(out, cap, "%s", tag);
    for (char *part = out; (part = strchr(part, '-')) != NULL;) {
        size_t length = strcspn(++part, "-");
        if (length == 1)
            return;
        if (length == 2)
            part[1] = (char)toupper((unsigned char)part[1]);
        if (length == 2 || (length == 4 && isalpha((unsigned char)*part)))
            *part = (char)toupper((unsigned char)*part);
    }
}

/* Plain voices are male unless stated. */
static const char *gender_name(int gender) {
    return gender == 2 ? "female" : "male";
}

/* Copies as many complete entries as fit and zeroes the rest. */
static void copy_langs(char *out, size_t cap, const char *langs) {
    size_t used = 0;
    for (size_t length; *langs; langs += length, used += length) {
        length = strlen(langs) + 1;
        if (used + length >= cap)
            return;
        memcpy(out + used, langs, length);
    }
}

static void add(struct es_voices *voices, const espeak_VOICE *voice) {
    const char *file = voice->identifier, *base = strrchr(file, '/');
    if (!strncmp(file, "mb/", 3) || !voice->languages || !*voice->languages)
        return;                             /* MBROLA voices have their own phones and samples */
    const char *tag = voice->languages + 1; /* after its priority */
    voices->list = mem_grow(voices->list, &voices->cap, voices->count + 1, sizeof *voices->list);
    struct es_voice *v = &voices->list[voices->count];
    *v = (struct es_voice){.gender = gender_name(voice->gender)};
    snprintf(v->id, sizeof v->id, "%s", es_voices_find(voices, tag) ? (base ? base + 1 : file) : tag);
    for (char *c = v->id; *c; c++)
        *c = (char)tolower((unsigned char)*c);
    snprintf(v->file, sizeof v->file, "%s", file);
    snprintf(v->name, sizeof v->name, "%s", voice->name);
    write_tag(v->lang, sizeof v->lang, strcmp(tag, "pt") ? tag : "pt-pt"); /* its plain pt is European */
    copy_langs(v->langs, sizeof v->langs, voice->languages);
    if (!es_voices_find(voices, v->id))
        voices->count++;
}

static void append(char *to, size_t cap, const char *separator, const char *s) {
    size_t length = strlen(to);
    snprintf(to + length, cap - length, "%s%s", separator, s);
}

static void add_variants(struct es_voices *voices, const char *variant, int gender) {
    size_t plain = voices->count;
    for (size_t i = 0; i < plain; i++) {
        if (strchr(voices->list[i].id, '+'))
            continue;
        voices->list = mem_grow(voices->list, &voices->cap, voices->count + 1, sizeof *voices->list);
        struct es_voice *v = &voices->list[voices->count++];
        *v = voices->list[i];
        v->gender = gender_name(gender);
        append(v->id, sizeof v->id, "+", variant);
        append(v->file, sizeof v->file, "+", variant);
        append(v->name, sizeof v->name, ", ", variant);
    }
}

/* Priority of the voice for the tag, or -1. */
static int priority(const struct es_voice *v, const char *lang) {
    for (const char *entry = v->langs; *entry; entry += strlen(entry) + 1)
        if (!strcasecmp(entry + 1, lang))
            return (unsigned char)*entry;
    return -1;
}

/* Priority for the language without its region; unranked voices come last. */
static int rank(const struct es_voice *v) {
    char primary[sizeof v->lang];
    snprintf(primary, sizeof primary, "%.*s", (int)strcspn(v->lang, "-"), v->lang);
    int p = priority(v, primary);
    return p < 0 ? UINT8_MAX + 1 : p;
}

static int by_language(const void *a, const void *b) {
    const struct es_voice *v = a, *w = b;
    size_t primary = strcspn(v->lang, "-"), other = strcspn(w->lang, "-");
    int order = strncmp(v->lang, w->lang, primary < other ? primary : other);
    bool variant = strchr(v->id, '+'), variant_too = strchr(w->id, '+');
    if (order || primary != other)
        return order ? order : primary < other ? -1 : 1;
    if (variant != variant_too)
        return variant ? 1 : -1;
    if (*v->langs != *w->langs)
        return *v->langs - *w->langs;
    return rank(v) != rank(w) ? rank(v) - rank(w) : strcmp(v->id, w->id);
}

void es_voices_load(struct es_voices *voices, const char *const *variants, size_t variant_count) {
    const espeak_VOICE **list = espeak_ListVoices(NULL);
    for (size_t i = 0; list && list[i]; i++)
        add(voices, list[i]);
    espeak_VOICE of_variants = {.languages = "variant"};
    list = espeak_ListVoices(&of_variants);
    for (size_t i = 0; i < variant_count; i++)
        for (size_t k = 0; list && list[k]; k++)
            if (!strncmp(list[k]->identifier, "!v/", 3) && !strcmp(list[k]->identifier + 3, variants[i]))
                add_variants(voices, variants[i], list[k]->gender);
    if (voices->count)
        qsort(voices->list, voices->count, sizeof *voices->list, by_language);
}

void es_voices_free(struct es_voices *voices) {
    free(voices->list);
    *voices = (struct es_voices){0};
}

const struct es_voice *es_voices_find(const struct es_voices *voices, const char *id) {
    for (size_t i = 0; i < voices->count; i++)
        if (!strcmp(voices->list[i].id, id))
            return &voices->list[i];
    return NULL;
}

const struct es_voice *es_voices_for_lang(const struct es_voices *voices, const char *lang) {
    size_t primary = strcspn(lang, "-");
    const struct es_voice *best = NULL, *same_language = NULL;
    for (size_t i = 0; i < voices->count; i++) {
        const struct es_voice *v = &voices->list[i];
        int p = priority(v, lang);
        if (p >= 0 && (!best || p < priority(best, lang)))
            best = v;
        if (!same_language && !strncasecmp(v->lang, lang, primary) && strcspn(v->lang, "-") == primary)
            same_language = v;
    }
    return best ? best : same_language;
}
