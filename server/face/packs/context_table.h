/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visemes that depend on their phonetic context (P. D. P. Costa, UNICAMP 2009, chapters 3 and 4, after J. M.
 * De Martino 2005): which of a set of mouth shapes a sound has, seen the two sounds before and the two after
 * it. A language's table is a file, models/speech/visemes/NAME.json; its format is described in
 * models/speech/README.md. */
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
    } * exceptions; /* the first one that fits counts */
    size_t exception_count;
    /* consonants, by the class of the vowel before (0 = none, else 1 + class) and of the one after: */
    size_t grid[CONTEXT_MAX_CLASSES + 1][CONTEXT_MAX_CLASSES];
};

/* Where one side of a consonant's context comes from. */
struct context_source {
    enum {
        CONTEXT_FROM_PLACE,  /* the vowel at place 0..4 */
        CONTEXT_FROM_CLASS,  /* that class, as if such a vowel stood there */
        CONTEXT_FROM_NONE,   /* silence */
        CONTEXT_FROM_BEFORE, /* the nearest vowel before the consonant, with no silence between */
        CONTEXT_FROM_AFTER   /* and after it */
    } kind;
    size_t value;
};

struct context_rule {
    unsigned number;             /* in table 4.9 */
    uint64_t at[CONTEXT_WINDOW]; /* the sounds that may stand there, bit = sound */
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
    struct context_rule *rules; /* the first one that fits counts */
    size_t rule_count;
    /* for what no rule fits: the first source that is there */
    struct context_source left[CONTEXT_MAX_CHOICES], right[CONTEXT_MAX_CHOICES];
    size_t left_count, right_count;
};

/* Every phone of the pack must be shown as one of the table's. NULL with *e (field = JSON path) when the file
 * is not as it must be. */
struct context_table *context_table_load(const char *path, const struct speech_pack *pack, struct error *e);
void context_table_free(struct context_table *table);

/* The sound of a pack's phone; NULL = silence. */
size_t context_sound(const struct context_table *table, const struct speech_phone *phone);

/* A phone by its IPA name or its symbol in transcriptions, or NULL. */
const struct context_phone *context_phone_named(const struct context_table *table, const char *name);

/* The sound of a phone by its IPA name or its symbol in transcriptions, or -1. */
long context_sound_named(const struct context_table *table, const char *name);

/* The classes of the vowels that a consonant is taken to stand between (0 = none, else 1 + class); the number
 * of the rule, 0 when none fitted. */
unsigned context_map(const struct context_table *table, const size_t sounds[CONTEXT_WINDOW], size_t *left,
                     size_t *right);

/* The shape of sounds[2]: an index of the shapes. */
size_t context_shape(const struct context_table *table, const size_t sounds[CONTEXT_WINDOW]);

#endif
