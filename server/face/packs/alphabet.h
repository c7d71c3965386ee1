/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A phonetic alphabet: its letters with their articulatory features (models/speech/alphabets/), to find what
 * a phone that a pack lacks looks most like. */
#ifndef FACCIA_FACE_PACKS_ALPHABET_H
#define FACCIA_FACE_PACKS_ALPHABET_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct letter {
    uint32_t code; /* Unicode */
    bool vowel;
    /* vowel: height 0 close..1 open, depth 0 front..1 back, rounded 0 or 1.
     * consonant: place and manner as indices of the lists in alphabet.c, voiced 0 or 1. */
    double height, depth, rounded;
    size_t place, manner;
    double voiced;
};

struct alphabet {
    struct letter *letters; /* sorted by code */
    size_t count;
};

/* NULL with *e (field = JSON path) when the file is not as it must be. */
struct alphabet *alphabet_load(const char *path, struct error *e);
void alphabet_free(struct alphabet *alphabet);

const struct letter *alphabet_find(const struct alphabet *alphabet, uint32_t code);

/* How unlike two letters look and, less, sound: 0 for the same. A difference in what the lips do weighs most.
 */
double letter_distance(const struct letter *a, const struct letter *b);

/* Marks that modify the letter beside them or join letters: combining diacritics (U+0300..U+036F, ties among
 * them, U+1DC0..U+1DFF), spacing modifier letters (U+02B0..U+02FF: length, aspiration, stress, tones...) and
 * raised ones (U+1D2C..U+1D6A, U+2070..U+209F: prenasalised and the like). */
bool alphabet_is_modifier(uint32_t code);

#endif
