/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names and stress of phones. espeak-ng's events carry time and its own name of each phone; the clause's
 * transcription carries IPA, length and stress without times. They differ: pauses at the end of a clause
 * are only events, and a phone written as a modifier letter is joined to the previous one. So the two
 * sequences are aligned. */
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

/* IPA seen for each mnemonic, for phones without a counterpart. Per voice: zero it for another one. */
struct es_names {
    struct {
        char symbol[12], ipa[20];
    } entries[256];
    size_t count;
};

/* Separator of phones in a transcription (espeak_SetPhonemeTrace). Words are separated by spaces. */
#define ES_SEPARATOR 0x1f

/* Sets ipa and stress of one clause's phones from its IPA transcription. */
void es_align(struct es_phone *phones, size_t count, const char *transcription, struct es_names *names);

#endif
