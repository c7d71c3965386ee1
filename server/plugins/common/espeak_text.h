/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts phones in IPA to espeak-ng's names. The phones of a voice and their names are learnt by asking
 * the engine for the IPA of every possible name. */
#ifndef FACCIA_COMMON_ESPEAK_TEXT_H
#define FACCIA_COMMON_ESPEAK_TEXT_H

#include "server/base/buf.h"
#include "server/plugins/common/espeak_voices.h"
#include "server/voice/faccia-voice.h"
#include <stdbool.h>
#include <stddef.h>

struct es_ipa {
    struct es_ipa_phone {
        char ipa[20];
        char name[5]; /* "" = no such phone */
    } * list;         /* sorted */
    size_t count, cap;
};

/* Learns the current voice's phones if the sentence gives phones and the table is empty. Returns true if
 * the engine was used, which calls its callback with user_data. */
bool es_ipa_learn(struct es_ipa *table, const struct faccia_sentence *sentence, void *user_data);
void es_ipa_free(struct es_ipa *table);

/* Converts one word to "[[...]]", skipping ties, syllable marks and the like. A missing phone is replaced
 * by its nearest relative, if any, and *changed is set. Returns 0; or -1 with the symbol that cannot be
 * spoken in unknown, without adding anything. */
int es_ipa_word(const struct es_ipa *table, const char *ipa, size_t bytes, struct buf *out, char unknown[8],
                bool *changed);

/* Text for espeak-ng, and words from its events. A sentence becomes plain text if all spans sound alike,
 * else SSML, with a map from its characters to the spans. Word events end at apostrophes and split numbers
 * and addresses; they are mapped to words as a reader sees them. */

struct es_text;

struct es_word {
    uint32_t start;       /* sample */
    size_t position;      /* character of the text, 0-based */
    bool empty;           /* reported without a length: a word only if letters follow */
    uint32_t span;        /* set by es_words_locate */
    size_t offset, bytes; /* in the span's text; bytes 0 = part of the previous word */
};

struct es_words {
    struct es_word *list;
    size_t count, cap;
};

/* Finds the place of each word in its span. */
void es_words_locate(struct es_words *words, const struct es_text *text,
                     const struct faccia_sentence *sentence);

/* Adds the words that the engine spoke together with the one before and did not report ("for the", "out
 * of", "pro capite"), each from the phone nearest to its share of the time. Call after es_words_locate.
 * phones: starts of the phones, sorted; end: where the last one ends. */
void es_words_complete(struct es_words *words, const struct faccia_sentence *sentence, const uint32_t *phones,
                       size_t phone_count, uint32_t end);

/* espeak-ng's parameters: words per minute, 0..99 with 50 as normal (twice), percent. */
struct es_prosody {
    int rate, pitch, range, volume;
};

/* From 450 on espeak-ng speeds up its finished audio (libsonic), and event times no longer match. */
enum { ES_RATE_OWN = 175, ES_RATE_MIN = 80, ES_RATE_MAX = 449 };

/* Maximum break, s. */
enum { ES_BREAK_MAX = 600 };

struct es_place {
    uint32_t span;   /* UINT32_MAX = markup */
    uint32_t offset; /* in the span's text, bytes */
};

struct es_text {
    struct buf text; /* NUL-terminated */
    bool ssml;
    bool phones;               /* contains phones as "[[...]]" */
    struct es_prosody prosody; /* of the whole text, before the SSML's changes */
    struct es_place *places;   /* of every character of the text */
    size_t place_count, place_cap;
};

/* ipa: the voice's phones, if any span has phones. warn is called for unsupported features. */
void es_text_make(struct es_text *text, const struct faccia_sentence *sentence, const struct es_voice *voice,
                  const struct es_voices *voices, const struct es_ipa *ipa,
                  void (*warn)(void *ctx, const char *message), void *ctx);

void es_text_free(struct es_text *text);

#endif
