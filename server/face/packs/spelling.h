/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mouth shapes by letter and vowel of the syllable (E. Akagündüz, METU 2004), for languages that are spelled
 * as they sound. A language's table is a file, models/speech/letters/NAME.json; its format is described in
 * models/speech/README.md. */
#ifndef FACCIA_FACE_PACKS_SPELLING_H
#define FACCIA_FACE_PACKS_SPELLING_H

#include "server/face/engines/phone_segments.h"
#include "server/face/packs/shape_table.h"

enum { SPELLING_MAX_CLASSES = 8 };

struct spelling_letter {
    uint32_t code; /* Unicode, lower case */
    bool vowel;
    size_t class;                        /* vowels: what consonants of their syllable see */
    bool like_vowel;                     /* consonants that have the shape of their syllable's vowel */
    size_t shapes[SPELLING_MAX_CLASSES]; /* consonants: by that class; vowels: the first */
    double seconds;                      /* mean duration, table 5.4 */
    const struct speech_phone *phone;    /* the pack's phone that it stands for */
};

struct spelling {
    struct shape_table common; /* whose entries are the letters */
    struct spelling_letter *letters;
    size_t letter_count;
    /* what is written in place of another character: small letters for capitals, in the language's own way */
    struct spelling_fold {
        uint32_t code;
        char *text;
    } * folds;
    size_t fold_count;
};

/* One letter of a word. */
struct spelled {
    const struct spelling_letter *letter;
    const struct spelling_letter *vowel; /* of its syllable; NULL in a word without vowels */
    size_t syllable;                     /* counted from 0 */
};

/* Every phone of the pack must be shown by a letter. NULL with *e (field = JSON path) when the file is not as
 * it must be. */
struct spelling *spelling_load(const char *path, const struct speech_pack *pack, struct error *e);
void spelling_free(struct spelling *spelling);

/* The letter that shows a phone of the pack. */
const struct spelling_letter *spelling_of_phone(const struct spelling *spelling,
                                                const struct speech_phone *phone);

/* Cuts a word into letters, folded; what is no letter is skipped. The caller frees *out; vowels and syllables
 * are filled by spelling_syllables. */
size_t spelling_read(const struct spelling *spelling, const char *word, struct spelled **out);

/* Finds the syllables of a word: one vowel each. Of the consonants between two vowels the last one begins the
 * next syllable (so a-ni-mas-yon, fark-lı, kontrp-lak); those before the first vowel belong to the first
 * syllable (prog-ra-mı-mız, tren), where the thesis's own scan leaves them over. */
void spelling_syllables(struct spelled *letters, size_t count);

/* The index of a letter's shape. */
size_t spelling_shape(const struct spelling *spelling, const struct spelled *letter);

/* For voices that tell only when words begin: the segments of the words' letters, with durations from the
 * table. A word begins when the voice says so, whatever became of the one before. Its letters fill the time
 * to the word's end where the voice knows it, else they follow the pace of the whole sentence and at the
 * latest end where the next word begins; what is left over is a pause. */
void spelling_segments(const struct spelling *spelling, const struct sentence_audio *u,
                       struct phone_segments *out);

#endif
