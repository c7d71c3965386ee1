/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One sentence for a voice: a sentence of a score as spans of the plugin interface, with the mapping from
 * a place in a span back to the input's bytes. */
#ifndef FACCIA_VOICE_VOICE_REQUEST_H
#define FACCIA_VOICE_VOICE_REQUEST_H

#include "server/markup/score.h"
#include "server/voice/faccia-voice.h"

/* A score item within a span's text. */
struct request_piece {
    uint32_t span;
    size_t offset, bytes; /* in the span's text */
    size_t from, to;      /* bytes of the input */
    bool verbatim;        /* text equals the input, so offsets map one to one */
};

/* The part of a score's cue that lies in the sentence. */
struct request_cue {
    const char *kind; /* owned by the request, like name */
    const char *name;
    size_t from, to;                         /* bytes of the input; from == to: a point before what follows */
    double intensity, weight, onset, offset; /* as in score_cue */
    struct score_time delay, duration;
    bool began_before, goes_on;
};

struct voice_request {
    struct faccia_span *spans; /* with owned strings */
    size_t span_count, span_cap;
    struct request_piece *pieces; /* in the order of the spans */
    size_t piece_count, piece_cap;
    struct request_cue *cues;
    size_t cue_count, cue_cap;
    size_t from, to;             /* the sentence's bytes of the input */
    size_t last_bytes, last_cap; /* of the last span's text */
    size_t text_bytes;           /* of all spans */
    double break_seconds;        /* of all breaks */
    char *before, *after;        /* surrounding text, for voices that want it; NULL = none */
};

/* Prosody that multiplies or replaces the score's styles. */
struct voice_prosody {
    double rate;          /* words per minute, 0 = the voice's own */
    double own_rate;      /* the voice's own words per minute */
    double pitch, volume; /* factors */
    bool chosen;          /* the voice was chosen for the styles' languages, so they are not passed on */
    bool plays;           /* the voice expresses emotions, so they are passed on */
};

/* Makes the request for a whole sentence. Adjacent text items of one style become one span, so that no
 * word is cut. Sounds are skipped and their alternate content is spoken. The score's cues must be in order
 * (score_order_cues); the score may be freed afterwards. */
void voice_request_make(struct voice_request *request, const struct score *score, size_t sentence,
                        const struct voice_prosody *prosody);

/* The same for items [first, first + count) of a sentence, without cues; and for the cues of a sentence
 * alone. */
void voice_request_items(struct voice_request *request, const struct score *score, size_t first, size_t count,
                         const struct voice_prosody *prosody);
void voice_request_cues(struct voice_request *request, const struct score *score, size_t sentence);

/* Adds the text around the items, for a voice with FACCIA_VOICE_CONTEXT. */
enum { VOICE_CONTEXT_BYTES = 400 }; /* on each side */
void voice_request_context(struct voice_request *request, const struct score *score, size_t sentence,
                           size_t first, size_t count);

/* The request in the plugin interface's form; borrows from both arguments. */
struct faccia_sentence voice_request_sentence(const struct voice_request *request, const char *voice);

/* Ends the request's text with a comma, because the sentence continues: otherwise the voice would lower
 * its pitch. */
void voice_request_continue(struct voice_request *request);

/* Copies a part of a span's text, in whole characters; "" if it is empty. */
char *voice_request_text(const struct voice_request *request, uint32_t span, size_t offset, size_t bytes);

void voice_request_free(struct voice_request *request);

/* Maps a part of a span's text to the input's bytes, widened to whole characters and clipped to the text.
 * Returns false when nothing is left. */
bool voice_request_locate(const struct voice_request *request, uint32_t span, size_t offset, size_t bytes,
                          size_t *from, size_t *to);

#endif
