/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words: from espeak-ng's word events, whose lengths stop at apostrophes and which split numbers and
 * addresses, to stretches of the text that a reader would call words. */
#ifndef FACCIA_COMMON_ESPEAK_TEXT_H
#define FACCIA_COMMON_ESPEAK_TEXT_H

#include "server/base/buf.h"
#include "server/plugins/common/espeak_ipa.h"
#include "server/plugins/common/espeak_voices.h"
#include "server/voice/faccia-voice.h"
#include <stdbool.h>

struct es_text;

struct es_word {
    uint32_t start;       /* sample */
    size_t position;      /* character of the text, 0-based */
    bool empty;           /* reported without a length: a word all the same if letters follow */
    uint32_t span;        /* set by es_words_locate */
    size_t offset, bytes; /* in the span's text; bytes 0 = part of the word before */
};

struct es_words {
    struct es_word *list;
    size_t count, cap;
};

/* Finds the place of each word in its span. */
void es_words_locate(struct es_words *words, const struct es_text *text,
                     const struct faccia_sentence *sentence);

/* The text that espeak-ng is given for a sentence: plain when all spans sound alike, SSML when they do not,
 * with the way back from its characters to the spans. */

/* espeak-ng's own parameters: words per minute, 0..99 with 50 as normal (twice), percent. */
struct es_prosody {
    int rate, pitch, range, volume;
};

/* From 450 on espeak-ng speeds its finished audio up (libsonic), and the times of its events do not follow.
 */
enum { ES_RATE_OWN = 175, ES_RATE_MIN = 80, ES_RATE_MAX = 449 };

/* No break is longer: seconds. */
enum { ES_BREAK_MAX = 600 };

struct es_place {
    uint32_t span;   /* UINT32_MAX: markup */
    uint32_t offset; /* in the span's text, bytes */
};

struct es_text {
    struct buf text; /* ends with NUL */
    bool ssml;
    bool phones;               /* phones are named in it, as "[[...]]" */
    struct es_prosody prosody; /* of the whole, before what the SSML changes */
    struct es_place *places;   /* of every character of the text */
    size_t place_count, place_cap;
};

/* ipa: the phones of the voice, if any span has phones. warn is called for what cannot be done. */
void es_text_make(struct es_text *text, const struct faccia_sentence *sentence, const struct es_voice *voice,
                  const struct es_voices *voices, const struct es_ipa *ipa,
                  void (*warn)(void *ctx, const char *message), void *ctx);

void es_text_free(struct es_text *text);

#endif
