/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mouth shapes by letter and vowel of the syllable (E. Akagündüz, METU 2004), for phonemically spelled
 * languages. A language's table is models/speech/letters/NAME.json, described in models/speech/README.md. */
#ifndef FACCIA_FACE_PACKS_SPELLING_H
#define FACCIA_FACE_PACKS_SPELLING_H

#include "server/face/engines/phone_segments.h"
#include "server/face/packs/shape_table.h"

enum { SPELLING_MAX_CLASSES = 8 };

struct spelling_letter {
    uint32_t code; /* Unicode, lower case */
    bool vowel;
    size_t class;                        /* vowels: class seen by consonants of the syllable */
    bool like_vowel;                     /* consonants shaped like their syllable's vowel */
    size_t shapes[SPELLING_MAX_CLASSES]; /* consonants: by vowel class; vowels: the first */
    double seconds;                      /* mean duration, table 5.4 */
    const struct speech_phone *phone;    /* the pack's phone that it represents */
};

struct spelling {
    struct shape_table common; /* whose entries are the letters */
    struct spelling_letter *letters;
    size_t letter_count;
    /* replacement of a character: lower case by the language's rules */
    struct spelling_fold {
        uint32_t code;
        char *text;
    } * folds;
    size_t fold_count;
};

/* A letter of a word. */
struct spelled {
    const struct spelling_letter *letter;
    const struct spelling_letter *vowel; /* of its syllable; NULL in a word without vowels */
    size_t syllable;                     /* counted from 0 */
};

/* Every phone of the pack must have a letter. Returns NULL with *e (field = JSON path) for an invalid
 * file. */
struct spelling *spelling_load(const char *path, const struct speech_pack *pack, struct error *e);
void spelling_free(struct spelling *spelling);

/* Returns the letter for a phone of the pack. */
const struct spelling_letter *spelling_of_phone(const struct spelling *spelling,
                                                const struct speech_phone *phone);

/* Splits a word into folded letters, skipping other characters. The caller frees *out; spelling_syllables
 * fills vowels and syllables. */
size_t spelling_read(const struct spelling *spelling, const char *word, struct spelled **out);

/* Finds the syllables of a word, one vowel each. The last consonant between two vowels starts the next
 * syllable (a-ni-mas-yon, fark-lı, kontrp-lak); consonants before the first vowel belong to the first
 * syllable (prog-ra-mı-mız, tren), where the thesis's algorithm omits them. */
void spelling_syllables(struct spelled *letters, size_t count);

/* Index of a letter's shape. */
size_t spelling_shape(const struct spelling *spelling, const struct spelled *letter);

/* Segments from letters with the table's durations, for voices that report only word starts. Words start
 * as reported. Letters fill the time to the word's end if known, else they follow the sentence's pace and
 * end at the next word's start; the rest is a pause. */
void spelling_segments(const struct spelling *spelling, const struct sentence_audio *u,
                       struct phone_segments *out);

#endif
