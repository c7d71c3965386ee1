/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text and prosody for Festival. Tokens: words in characters that the voice's rules can read, with
 * punctuation. Festival's rules fail or crash on anything else, so nothing else is passed on. */
#ifndef FACCIA_FESTIVAL_FESTIVAL_PIECE_H
#define FACCIA_FESTIVAL_FESTIVAL_PIECE_H

#include "server/base/buf.h"
#include "server/plugins/festival/festival_child.h"
#include "server/plugins/festival/festival_voices.h"

/* Factors, 1 = unchanged. */
struct fe_prosody {
    double stretch; /* of durations */
    double pitch;   /* of the mean fundamental frequency */
    double range;   /* of its range in octaves */
    double volume;  /* of the samples */
};

/* Maps prosody and emphasis of a span to these factors. Emotions are already contained in them
 * (models/expressions.json). */
struct fe_prosody fe_prosody_of(const struct fe_voice *voice, const struct faccia_span *span);

/* Scales the samples [from, to) by gain and a volume that moves from *now to its target within some ms; a
 * soft limiter prevents overflow. */
void fe_amplify(int16_t *samples, size_t from, size_t to, uint32_t sample_rate, double gain, double volume,
                double *now);

enum { FE_WORD_BYTES = 64, FE_PUNCTUATION_BYTES = 8 };

struct fe_token {
    char word[FE_WORD_BYTES]; /* ISO-8859-1 */
    char before[FE_PUNCTUATION_BYTES], after[FE_PUNCTUATION_BYTES];
    uint32_t span;
    size_t offset, bytes; /* in the span's text */
};

struct fe_tokens {
    struct fe_token *list;
    size_t count, cap;
    char unread[64]; /* unreadable characters, UTF-8, each once, for a warning */
};

/* Appends the tokens of a text; spell: one per letter and digit. */
void fe_tokens_add(struct fe_tokens *tokens, const struct fe_language *language, uint32_t span,
                   const char *text, bool spell);

/* Appends a token again in its simplest form: runs of letters, and single digits. */
void fe_tokens_add_plain(struct fe_tokens *tokens, const struct fe_token *token);

void fe_tokens_free(struct fe_tokens *tokens);

/* A part of a sentence that Festival synthesises at once: its tokens with prosody, the request, and
 * delivery of the answer to the sink. */

struct fe_said_phone {
    char name[16];
    double start, end; /* seconds */
    uint32_t stress;
};

struct fe_said_word {
    size_t token;
    double start, end;
};

struct fe_mark {
    const char *name;
    size_t token; /* the token it precedes */
};

struct fe_piece {
    const struct fe_voice *voice;
    const struct faccia_sink *sink;
    uint64_t at; /* samples delivered */
    struct fe_tokens tokens;
    struct fe_prosody *prosody; /* of each token */
    size_t prosody_cap;
    struct fe_mark *marks;
    size_t mark_count, mark_cap, marks_given;
    /* the answer */
    struct fe_said_phone *phones;
    size_t phone_count, phone_cap;
    struct fe_said_word *words;
    size_t word_count, word_cap;
    const int16_t *samples;
    size_t sample_count;
    uint32_t sample_rate;
};

void fe_piece_begin(struct fe_piece *piece, const struct fe_voice *voice, const struct faccia_sink *sink);
void fe_piece_free(struct fe_piece *piece);

/* Collect tokens. A mark precedes the text added next. */
void fe_piece_add(struct fe_piece *piece, uint32_t span, const char *text, bool spell,
                  const struct fe_prosody *prosody);
void fe_piece_mark(struct fe_piece *piece, const char *name);

/* Returns where a stretch of at most max tokens from `from` ends, after punctuation if there is any in its
 * second half. */
size_t fe_piece_cut(const struct fe_piece *piece, size_t from, size_t max);

/* Makes the request for the tokens [from, to), with `lead` and `trail` seconds of silence. plain: in plain
 * form. */
void fe_piece_request(const struct fe_piece *piece, size_t from, size_t to, bool plain, double lead,
                      double trail, struct buf *request);

/* Reads the answer. *refused: Festival reported an error instead. */
enum fe_result fe_piece_answer(struct fe_piece *piece, struct fe_child *child, bool *refused);

/* Delivers the answer for the tokens up to `to`, with the marks before them. Returns false when the sink
 * says stop. */
bool fe_piece_deliver(struct fe_piece *piece, size_t to);

/* Delivers the remaining marks and silence, and clears the piece. Returns false when the sink says stop. */
bool fe_piece_finish(struct fe_piece *piece, double seconds);

#endif
