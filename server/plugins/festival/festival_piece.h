/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stretch of a sentence that Festival synthesises at once: its tokens with their prosody, the request that
 * they make, and the answer on its way to the sink. */
#ifndef FACCIA_PLUGINS_FESTIVAL_FESTIVAL_PIECE_H
#define FACCIA_PLUGINS_FESTIVAL_FESTIVAL_PIECE_H

#include "server/base/buf.h"
#include "server/plugins/festival/festival_child.h"
#include "server/plugins/festival/festival_text.h"

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
    size_t token; /* before which it stands */
};

struct fe_piece {
    const struct fe_voice *voice;
    const struct faccia_sink *sink;
    uint64_t at; /* samples that the sink has */
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

/* Collecting. A mark stands before the text that is added next. */
void fe_piece_add(struct fe_piece *piece, uint32_t span, const char *text, bool spell,
                  const struct fe_prosody *prosody);
void fe_piece_mark(struct fe_piece *piece, const char *name);

/* The end of a stretch of tokens from `from` on that Festival can take at once: not more than max, and cut
 * after punctuation if there is any in its second half. */
size_t fe_piece_cut(const struct fe_piece *piece, size_t from, size_t max);

/* The request for the tokens [from, to), with so many seconds of silence at both ends. plain: in their plain
 * form. */
void fe_piece_request(const struct fe_piece *piece, size_t from, size_t to, bool plain, double lead,
                      double trail, struct buf *request);

/* Reads the answer. *refused: Festival reported an error instead. */
enum fe_result fe_piece_answer(struct fe_piece *piece, struct fe_child *child, bool *refused);

/* Hands the answer for the tokens up to `to` to the sink, with the marks before them. False when the sink
 * says stop. */
bool fe_piece_deliver(struct fe_piece *piece, size_t to);

/* Silence, after the marks that are left; what was collected is forgotten. False when the sink says stop. */
bool fe_piece_finish(struct fe_piece *piece, double seconds);

#endif
