/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/json_place.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/voice/assembly.h"
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Between a phone that ends with a letter of `before` and one that starts with a letter of `after`, the
 * boundary is heard `seconds` later than reported. Letters are IPA in UTF-8. */
struct boundary_rule {
    const char *before, *after;
    double seconds;
};

/* The first matching rule applies. */
struct voice_boundaries {
    const char *voice;
    struct boundary_rule *rules;
    size_t count;
};

struct boundary_table {
    json_t *root; /* owns the strings */
    struct voice_boundaries *voices;
    size_t count;
};

/* Looks up the letters of the sound named at `at`. */
static int read_sound(const struct json_place *at, const struct json_place *sounds, const char **out) {
    const char *name;
    if (json_place_text(at, &name))
        return -1;
    struct json_place sound = json_place_key(sounds, name);
    *out = json_string_value(sound.json);
    return sound.json ? 0 : json_place_fail(at, "unknown phone '%.80s'", name);
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

/* Length marks, aspiration and other modifier letters, and combining marks. */
static bool is_diacritic(uint32_t c) {
    return (c >= 0x2B0 && c <= 0x36F) || (c >= 0x1DC0 && c <= 0x1DFF);
}

/* The phone's first or last letter; 0 for a pause. */
static uint32_t letter_of(const struct phone *p, bool last) {
    uint32_t found = 0, c;
    size_t length, left = strlen(p->ipa);
    for (const char *s = p->ipa; left && (length = utf8_next(s, left, &c)) > 0; s += length, left -= length)
        if (!is_diacritic(c) && (last || !found))
            found = c;
    return found;
}

static bool has_letter(const char *letters, uint32_t letter) {
    uint32_t c;
    size_t length, left = strlen(letters);
    for (; left && (length = utf8_next(letters, left, &c)) > 0; letters += length, left -= length)
        if (c == letter)
            return true;
    return false;
}

static double shift_of(const struct voice_boundaries *b, const struct phone *before,
                       const struct phone *after) {
    uint32_t last = letter_of(before, true), first = letter_of(after, false);
    for (size_t i = 0; last && first && i < b->count; i++)
        if (has_letter(b->rules[i].before, last) && has_letter(b->rules[i].after, first))
            return b->rules[i].seconds;
    return 0;
}

/* Phone starts before the correction, plus the last end, and the corrected phones. */
struct warp {
    const uint32_t *was;
    const struct phone *phones;
    size_t count, at;
};

/* Maps a time by its position within its phone. Call with increasing times. */
static uint32_t warped(struct warp *w, uint32_t t) {
    while (w->at + 1 < w->count && t >= w->was[w->at + 1])
        w->at++;
    uint32_t from = w->was[w->at], length = w->was[w->at + 1] - from;
    const struct phone *p = &w->phones[w->at];
    if (t < from || !length || t >= w->was[w->count])
        return t;
    return p->start + (uint32_t)((uint64_t)(t - from) * (p->end - p->start) / length);
}

/* A phone of zero length stays so, because times at its place could belong to either side. */
static void move_phones(const struct voice_boundaries *b, struct sentence_audio *u, const uint32_t *was) {
    for (size_t i = 1; i < u->phone_count; i++) {
        struct phone *before = &u->phones[i - 1], *after = &u->phones[i];
        double earliest = (was[i] - was[i - 1]) / BOUNDARY_PART,
               latest = (was[i + 1] - was[i]) / BOUNDARY_PART;
        if (!earliest || !latest)
            continue;
        double shift = fmax(-earliest, fmin(latest, round(shift_of(b, before, after) * u->sample_rate)));
        before->end = after->start = (uint32_t)(was[i] + shift);
    }
}

void boundaries_correct(const struct voice_boundaries *b, struct sentence_audio *u) {
    if (!b || !u->phone_count)
        return;
    uint32_t *was = mem_alloc((u->phone_count + 1) * sizeof *was);
    for (size_t i = 0; i < u->phone_count; i++)
        was[i] = u->phones[i].start;
    was[u->phone_count] = u->phones[u->phone_count - 1].end;
    move_phones(b, u, was);
    struct warp words = {was, u->phones, u->phone_count, 0}, marks = words;
    for (size_t i = 0; i < u->word_count; i++) {
        u->words[i].start = warped(&words, u->words[i].start);
        u->words[i].end = warped(&words, u->words[i].end);
    }
    for (size_t i = 0; i < u->mark_count; i++)
        u->marks[i].at = warped(&marks, u->marks[i].at);
    free(was);
}
