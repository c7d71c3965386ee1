/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/engine.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
#include "server/face/engines/targets.h"
#include "server/face/packs/context_table.h"
#include "server/face/packs/spelling.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The first is the default. */
static const struct face_engine *const engines[] = {
    &engine_dominance, &engine_cohen_massaro, &engine_context,           &engine_syllable,
    &engine_table,     &engine_without_shape, &engine_without_resistance};
static const char *const names[] = {"dominance", "cohen-massaro", "context", "syllable", "table", NULL};
static const char *const ablations[] = {"dominance-no-shape", "dominance-no-resistance", NULL};

const struct face_engine *engine_find(const char *name) {
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++)
        if (!name || !strcmp(engines[i]->name, name))
            return engines[i];
    return NULL;
}

bool engine_has_contacts(const struct face_engine *engine, enum face_contacts contacts) {
    return contacts == CONTACTS_ENGINE ? engine->contacts : contacts == CONTACTS_ON;
}

const char *const *engine_ablations(void) {
    return ablations;
}

const char *const *engine_names(void) {
    return names;
}

/* Context engine: visemes that depend on context, each reached in the middle of its phone, with smooth
 * interpolation: no dominance, and a look-ahead of two sounds. */

static size_t sound_at(const struct context_table *table, const struct phone_segments *g, size_t i,
                       long offset) {
    long at = (long)i + offset;
    return at < 0 || at >= (long)g->count ? (size_t)CONTEXT_SILENCE
                                          : context_sound(table, g->items[at].phone);
}

/* A long pause holds the rest position, so that the mouth does not take half the pause to close. */
static void add_pause(struct morph *morph, const struct phone_segment *g, const struct speech_rest *rest,
                      const double *faps) {
    if (g->end - g->start > rest->reach + rest->leave) {
        morph_add(morph, g->start + rest->reach, faps);
        morph_add(morph, g->end - rest->leave, faps);
    } else {
        morph_add(morph, (g->start + g->end) / 2, faps);
    }
}

static struct speech_layer context_layer(const struct speech_pack *pack, const struct sentence_audio *u,
                                         struct phone_segments *g) {
    (void)u;
    const struct context_table *table = pack->visemes;
    const double *rest = table->common.shapes.items[table->common.rest].faps;
    struct morph morph = {.ease = MORPH_SMOOTH};
    morph_add(&morph, 0, rest);
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone) {
            add_pause(&morph, item, &pack->rest, rest);
            continue;
        }
        size_t sounds[CONTEXT_WINDOW];
        for (size_t k = 0; k < CONTEXT_WINDOW; k++)
            sounds[k] = sound_at(table, g, i, (long)k - CONTEXT_WINDOW / 2);
        morph_add(&morph, (item->start + item->end) / 2, /* (4.1) */
                  table->common.shapes.items[context_shape(table, sounds)].faps);
    }
    morph_add(&morph, g->end, rest);
    return morph_layer(&morph);
}

static bool context_speaks(const struct speech_pack *pack) {
    return pack->visemes != NULL;
}

const struct face_engine engine_context = {"context", true, context_speaks, context_layer};

/* Engines with one curve per articulatory parameter: the default, and what it is compared with. */

_Static_assert((int)PARAM_COUNT <= (int)SPEECH_CURSORS, "a cursor for each curve");

struct mouth {
    struct speech_fapu fapu;
    struct curve curves[PARAM_COUNT];
};

static void add(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]) {
    const struct mouth *mouth = self;
    double mm[PARAM_COUNT];
    for (int p = 0; p < PARAM_COUNT; p++) {
        struct curve_cursor at = {.next = cursor->at[p]};
        mm[p] = curve_at(&mouth->curves[p], t, &at);
        cursor->at[p] = at.next;
    }
    fapmap_add(&mouth->fapu, mm, faps);
}

static void articulation_free(void *self) {
    struct mouth *mouth = self;
    for (int p = 0; p < PARAM_COUNT; p++)
        curve_free(&mouth->curves[p]);
    free(mouth);
}

/* supports any pack */
static bool articulation_speaks(const struct speech_pack *pack) {
    return pack != NULL;
}

static struct speech_layer articulation_layer(const struct speech_pack *pack, const struct phone_segments *g,
                                              enum targets_function function) {
    struct mouth *mouth = mem_alloc(sizeof *mouth);
    mouth->fapu = pack->fapu;
    targets_curves(pack, g, function, mouth->curves);
    return (struct speech_layer){add, articulation_free, mouth};
}

/* One dominance curve per articulatory parameter. */
static struct speech_layer dominance(const struct speech_pack *pack, const struct sentence_audio *u,
                                     struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_LOOK_AHEAD);
}

/* Baseline: the original function of Cohen and Massaro (1993) with the same targets and coefficients.
 * Neighbours do not confine a segment and closures are not enforced, so fast speech loses them. */
static struct speech_layer original(const struct speech_pack *pack, const struct sentence_audio *u,
                                    struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_ORIGINAL);
}

/* The default engine with a part of its function removed, for measurements (faccia eval only). */
static struct speech_layer without_shape(const struct speech_pack *pack, const struct sentence_audio *u,
                                         struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_NO_SHAPE);
}

static struct speech_layer without_resistance(const struct speech_pack *pack, const struct sentence_audio *u,
                                              struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_NO_RESISTANCE);
}

const struct face_engine engine_dominance = {"dominance", true, articulation_speaks, dominance};
const struct face_engine engine_cohen_massaro = {"cohen-massaro", false, articulation_speaks, original};
const struct face_engine engine_without_shape = {"dominance-no-shape", true, articulation_speaks,
                                                 without_shape};
const struct face_engine engine_without_resistance = {"dominance-no-resistance", true, articulation_speaks,
                                                      without_resistance};

/* Table engine, the simplest baseline: one target per phone and parameter, the mean of the pack's targets
 * over all contexts, reached in the phone's middle with cosine interpolation. No context, dominance or
 * look-ahead. */

struct table_key {
    double at; /* s */
    double mm[PARAM_COUNT];
};

struct table {
    struct speech_fapu fapu;
    struct table_key *keys; /* strictly increasing in `at`; rest at both ends */
    size_t count, cap;
};

static void add_key(struct table *table, double at, const double mm[PARAM_COUNT]) {
    if (table->count && at <= table->keys[table->count - 1].at)
        return;
    table->keys = mem_grow(table->keys, &table->cap, table->count + 1, sizeof *table->keys);
    struct table_key *key = &table->keys[table->count++];
    key->at = at;
    for (int p = 0; p < PARAM_COUNT; p++)
        key->mm[p] = mm[p];
}

static void phone_targets(const struct speech_pack *pack, const struct phone_segment *item,
                          double mm[PARAM_COUNT]) {
    const struct speech_phone *phone = item->phone;
    size_t contexts = phone->group->vowel ? pack->vowel_context_count : pack->consonant_context_count;
    for (size_t p = 0; p < PARAM_COUNT; p++) {
        mm[p] = 0;
        for (size_t c = 0; c < contexts; c++) {
            double plain = phone->plain[c * PARAM_COUNT + p].T,
                   stressed = phone->stressed[c * PARAM_COUNT + p].T;
            mm[p] += (plain + item->stress * (stressed - plain)) / (double)contexts;
        }
    }
}

static void table_add(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]) {
    const struct table *table = self;
    (void)cursor;
    size_t low = 0, high = table->count - 1; /* bisection: the last key at or before t is in low..high - 1 */
    while (low + 1 < high) {
        size_t middle = (low + high) / 2;
        if (table->keys[middle].at <= t)
            low = middle;
        else
            high = middle;
    }
    const struct table_key *from = &table->keys[low], *to = &table->keys[high];
    double part = to == from ? 0 : fmin(fmax((t - from->at) / (to->at - from->at), 0), 1);
    double weight = (1 - cos(M_PI * part)) / 2, mm[PARAM_COUNT];
    for (int p = 0; p < PARAM_COUNT; p++)
        mm[p] = from->mm[p] + weight * (to->mm[p] - from->mm[p]);
    fapmap_add(&table->fapu, mm, faps);
}

static void table_free(void *self) {
    struct table *table = self;
    free(table->keys);
    free(table);
}

static struct speech_layer table_layer(const struct speech_pack *pack, const struct sentence_audio *u,
                                       struct phone_segments *g) {
    (void)u;
    struct table *table = mem_alloc(sizeof *table);
    double rest[PARAM_COUNT];
    table->fapu = pack->fapu;
    for (int p = 0; p < PARAM_COUNT; p++)
        rest[p] = pack->rest.coefficients[p].T;
    add_key(table, 0, rest);
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        double mm[PARAM_COUNT], length = item->end - item->start;
        if (item->phone) {
            phone_targets(pack, item, mm);
            add_key(table, (item->start + item->end) / 2, mm);
        } else if (length >
                   pack->rest.reach + pack->rest.leave) { /* so that closing does not take half the pause */
            add_key(table, item->start + pack->rest.reach, rest);
            add_key(table, item->end - pack->rest.leave, rest);
        } else {
            add_key(table, (item->start + item->end) / 2, rest);
        }
    }
    add_key(table, g->end, rest);
    return (struct speech_layer){table_add, table_free, table};
}

static bool table_speaks(const struct speech_pack *pack) {
    return pack != NULL;
}

const struct face_engine engine_table = {"table", false, table_speaks, table_layer};

/* Maximum stretch of words relative to the table; the rest becomes a pause. */
#define MAX_STRETCH 2.0
/* Maximum stretch relative to the sentence's usual word. */
#define MAX_UNEVEN 1.5
/* Shorter gaps belong to the previous word. */
#define MIN_PAUSE 0.04

struct room {
    double start, end; /* s: until the next word or the end of the audio */
    double said;       /* s: the word's end if the voice reports it, else 0 */
    double table;      /* s: duration by the table */
    struct spelled *letters;
    size_t count;
};

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median stretch of the words, so that pauses do not count. */
static double pace_of(const struct room *rooms, size_t count) {
    double *ratios = mem_alloc((count + 1) * sizeof *ratios), pace = 1;
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
        if (rooms[i].table > 0)
            ratios[used++] = (rooms[i].end - rooms[i].start) / rooms[i].table;
    if (used) {
        qsort(ratios, used, sizeof *ratios, ascending);
        pace = ratios[(used - 1) / 2];
    }
    free(ratios);
    return fmin(pace, MAX_STRETCH);
}

static double scale_of(const struct room *room, double pace) {
    if (room->said > room->start)
        return (room->said - room->start) / room->table;
    return fmin((room->end - room->start) / room->table, fmin(MAX_UNEVEN * pace, MAX_STRETCH));
}

static void add_segment(struct phone_segments *g, const struct speech_phone *phone, double start,
                        double end) {
    if (end <= start && !phone)
        return;
    g->items = mem_grow(g->items, &g->cap, g->count + 1, sizeof *g->items);
    g->items[g->count++] = (struct phone_segment){phone, start, end, phone ? 0.5 : 0, 1};
}

static void read_rooms(const struct spelling *spelling, const struct sentence_audio *u, double rate,
                       double end, struct room *rooms) {
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        struct room *room = &rooms[i];
        room->start = w->start / rate;
        room->end = i + 1 < u->word_count ? u->words[i + 1].start / rate : end;
        room->said = w->end > w->start && w->end / rate < room->end ? w->end / rate : 0;
        room->count = spelling_read(spelling, w->text ? w->text : "", &room->letters);
        for (size_t k = 0; k < room->count; k++)
            room->table += room->letters[k].letter->seconds;
    }
}

void spelling_segments(const struct spelling *spelling, const struct sentence_audio *u,
                       struct phone_segments *out) {
    double rate = u->sample_rate ? u->sample_rate : 1;
    *out = (struct phone_segments){.end = u->samples / rate};
    struct room *rooms = mem_alloc((u->word_count + 1) * sizeof *rooms);
    read_rooms(spelling, u, rate, out->end, rooms);
    double pace = pace_of(rooms, u->word_count), at = 0;
    for (size_t i = 0; i < u->word_count; i++) {
        struct room *room = &rooms[i];
        add_segment(out, NULL, at, room->start);
        at = room->start;
        double scale = room->count ? scale_of(room, pace) : 0;
        for (size_t k = 0; k < room->count; k++) {
            double end = at + scale * room->letters[k].letter->seconds;
            if (k + 1 == room->count && room->end - end < MIN_PAUSE)
                end = room->end;
            add_segment(out, room->letters[k].letter->phone, at, end);
            at = end;
        }
        free(room->letters);
    }
    add_segment(out, NULL, at, out->end);
    free(rooms);
}

/* Syllable engine: one shape per letter, chosen with the vowel of its syllable, linearly interpolated (E.
 * Akagündüz, METU 2004, chapter 5): during a letter its shape changes into the next. Letters come from the
 * voice's phones, so that numbers and abbreviations are shown as spoken; only without phones from the
 * words' text. */

/* Tolerance for a word that begins within a phone reported for both words. */
#define WORD_SLACK 0.001

static bool has_phones(const struct phone_segments *g) {
    for (size_t i = 0; i < g->count; i++)
        if (g->items[i].phone)
            return true;
    return false;
}

/* Counts the segments from i on that form one word: up to a pause or the next word's start. */
static size_t word_length(const struct sentence_audio *u, const struct phone_segments *g, size_t i,
                          size_t *word) {
    double rate = u->sample_rate ? u->sample_rate : 1;
    while (*word < u->word_count && u->words[*word].start / rate <= g->items[i].start + WORD_SLACK)
        ++*word;
    double end = *word < u->word_count ? u->words[*word].start / rate : INFINITY;
    size_t n = 1;
    while (i + n < g->count && g->items[i + n].phone && g->items[i + n].start + WORD_SLACK < end)
        n++;
    return n;
}

static void add_word(struct morph *morph, const struct spelling *spelling, const struct phone_segment *items,
                     size_t n) {
    struct spelled *letters = mem_alloc(n * sizeof *letters);
    for (size_t i = 0; i < n; i++)
        letters[i].letter = spelling_of_phone(spelling, items[i].phone);
    spelling_syllables(letters, n);
    for (size_t i = 0; i < n; i++) {
        /* the mouth needs time for its first shape: half of the sound */
        double at = items[i].start > 0 ? items[i].start : items[i].end / 2;
        morph_add(morph, at, spelling->common.shapes.items[spelling_shape(spelling, &letters[i])].faps);
    }
    free(letters);
}

static struct speech_layer syllable_layer(const struct speech_pack *pack, const struct sentence_audio *u,
                                          struct phone_segments *g) {
    const struct spelling *spelling = pack->letters;
    const double *neutral = spelling->common.shapes.items[spelling->common.rest].faps;
    if (!has_phones(g) && u->word_count) {
        phone_segments_free(g);
        spelling_segments(spelling, u, g);
    }
    struct morph morph = {.ease = MORPH_LINEAR};
    morph_add(&morph, 0, neutral);
    size_t word = 0;
    for (size_t i = 0; i < g->count;) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone) {
            morph_add(&morph, item->start, neutral);
            morph_add(&morph, item->end - pack->rest.leave, neutral);
            i++;
            continue;
        }
        size_t n = word_length(u, g, i, &word);
        add_word(&morph, spelling, item, n);
        i += n;
    }
    morph_add(&morph, g->end, neutral);
    return morph_layer(&morph);
}

static bool syllable_speaks(const struct speech_pack *pack) {
    return pack->letters != NULL;
}

const struct face_engine engine_syllable = {"syllable", true, syllable_speaks, syllable_layer};
