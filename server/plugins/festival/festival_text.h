/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What Festival is to do to a span's durations and fundamental frequency, and the plugin to its samples. */
#ifndef FACCIA_FESTIVAL_FESTIVAL_TEXT_H
#define FACCIA_FESTIVAL_FESTIVAL_TEXT_H

#include "server/plugins/festival/festival_voices.h"

/* Factors, 1 = as the voice does it. */
struct fe_prosody {
    double stretch; /* of durations */
    double pitch;   /* of the mean fundamental frequency */
    double range;   /* of its range in octaves */
    double volume;  /* of the samples */
};

/* Emphasis is mapped to the same four. Emotions come as factors already (models/expressions.json). */
struct fe_prosody fe_prosody_of(const struct fe_voice *voice, const struct faccia_span *span);

/* Multiplies the samples [from, to) by gain times a volume, which moves there from *now within some ms; what
 * would not fit 16 bits is bent. */
void fe_amplify(int16_t *samples, size_t from, size_t to, uint32_t sample_rate, double gain, double volume,
                double *now);

/* From a span's text to Festival's tokens: words in the characters that the voice's rules can read, with the
 * punctuation round them. Festival's rules fail, or crash it, on what they do not know; so nothing else is
 * let through. */

enum { FE_WORD_BYTES = 64, FE_PUNCTUATION_BYTES = 8 };

struct fe_token {
    char word[FE_WORD_BYTES]; /* ISO-8859-1 */
    char before[FE_PUNCTUATION_BYTES], after[FE_PUNCTUATION_BYTES];
    uint32_t span;
    size_t offset, bytes; /* of the word in the span's text */
};

struct fe_tokens {
    struct fe_token *list;
    size_t count, cap;
    char unread[64]; /* characters that cannot be read, UTF-8, each once; for a warning */
};

/* Appends the tokens of a text; spell: each letter and digit is one. */
void fe_tokens_add(struct fe_tokens *tokens, const struct fe_language *language, uint32_t span,
                   const char *text, bool spell);

/* Appends a token again, in pieces that no rule can stumble over: runs of letters, and single digits. */
void fe_tokens_add_plain(struct fe_tokens *tokens, const struct fe_token *token);

void fe_tokens_free(struct fe_tokens *tokens);

#endif
