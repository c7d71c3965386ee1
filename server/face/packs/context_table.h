/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Context-dependent visemes (P. D. P. Costa, UNICAMP 2009, chapters 3 and 4, after J. M. De Martino 2005):
 * selects a sound's mouth shape by the two sounds before and after it. A language's table is
 * models/speech/visemes/NAME.json, described in models/speech/README.md. */
#ifndef FACCIA_FACE_PACKS_CONTEXT_TABLE_H
#define FACCIA_FACE_PACKS_CONTEXT_TABLE_H

#include "server/face/packs/shape_table.h"

enum { CONTEXT_MAX_GROUPS = 62, CONTEXT_MAX_CLASSES = 8, CONTEXT_MAX_CHOICES = 4, CONTEXT_WINDOW = 5 };

/* A sound: silence, or 1 + the index of its group. */
enum { CONTEXT_SILENCE = 0 };

struct context_group {
    char *name;
    bool vowel;
    /* vowels: */
    size_t class, shape;
    struct context_exception {
        uint64_t before, after; /* sets of sounds, bit = sound */
        size_t shape;
    } * exceptions; /* the first match applies */
    size_t exception_count;
    /* consonants, by the class of the vowel before (0 = none, else 1 + class) and of the one after: */
    size_t grid[CONTEXT_MAX_CLASSES + 1][CONTEXT_MAX_CLASSES];
};

/* The source of one side of a consonant's context. */
struct context_source {
    enum {
        CONTEXT_FROM_PLACE,  /* the vowel at place 0..4 */
        CONTEXT_FROM_CLASS,  /* a fixed class, independent of the vowels around */
        CONTEXT_FROM_NONE,   /* silence */
        CONTEXT_FROM_BEFORE, /* the nearest vowel before the consonant without silence between */
        CONTEXT_FROM_AFTER   /* the same after it */
    } kind;
    size_t value;
};

struct context_rule {
    unsigned number;             /* in table 4.9 */
    uint64_t at[CONTEXT_WINDOW]; /* the sounds allowed there, bit = sound */
    struct context_source left, right;
};

struct context_phone {
    char *ipa;
    size_t sound;
    char **symbols; /* in timed transcriptions */
};

struct context_table {
    struct shape_table common; /* whose entries are the phones */
    struct context_group *groups;
    size_t group_count;
    struct context_phone *phones;
    size_t phone_count;
    struct context_rule *rules; /* the first match applies */
    size_t rule_count;
    /* used if no rule matches: the first available source */
    struct context_source left[CONTEXT_MAX_CHOICES], right[CONTEXT_MAX_CHOICES];
    size_t left_count, right_count;
};

/* The table must cover every phone of the pack. Returns NULL with *e (field = JSON path) for an invalid
 * file. */
struct context_table *context_table_load(const char *path, const struct speech_pack *pack, struct error *e);
void context_table_free(struct context_table *table);

/* The sound of a pack's phone; NULL = silence. */
size_t context_sound(const struct context_table *table, const struct speech_phone *phone);

/* Finds a phone by its IPA name or transcription symbol, or NULL. */
const struct context_phone *context_phone_named(const struct context_table *table, const char *name);

/* Finds the sound of a phone by its IPA name or transcription symbol, or -1. */
long context_sound_named(const struct context_table *table, const char *name);

/* Determines the classes of the vowels around a consonant (0 = none, else 1 + class). Returns the number
 * of the rule, 0 if none matched. */
unsigned context_map(const struct context_table *table, const size_t sounds[CONTEXT_WINDOW], size_t *left,
                     size_t *right);

/* Index of the shape of sounds[2]. */
size_t context_shape(const struct context_table *table, const size_t sounds[CONTEXT_WINDOW]);

#endif
