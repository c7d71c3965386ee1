/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names and stress of phones. espeak-ng's events carry the time and the engine's own name of each phone; its
 * transcription of the clause carries IPA, length and stress but no times. Both walk the same list, but not
 * all of it: pauses at the end of a clause are events only, and a phone written as a modifier letter is glued
 * to the one before. So the two are aligned. */
#ifndef FACCIA_PLUGINS_COMMON_ESPEAK_ALIGN_H
#define FACCIA_PLUGINS_COMMON_ESPEAK_ALIGN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct es_phone {
    char symbol[12];     /* espeak-ng's mnemonic */
    char ipa[20];        /* "" = none */
    uint32_t start, end; /* samples */
    uint8_t stress;      /* as in struct faccia_phone */
    bool pause;
};

/* IPA seen for each mnemonic, for the rare phone that has no counterpart. Belongs to one voice: zero it for
 * another. */
struct es_names {
    struct {
        char symbol[12], ipa[20];
    } entries[256];
    size_t count;
};

/* What separates the phones of a transcription (espeak_SetPhonemeTrace). Words are separated by spaces. */
#define ES_SEPARATOR 0x1f

/* Sets ipa and stress of the phones of one clause from its transcription in IPA. */
void es_align(struct es_phone *phones, size_t count, const char *transcription, struct es_names *names);

#endif
