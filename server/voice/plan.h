/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a voice is asked to speak: one sentence of a score as the spans of the plugin interface, and the way
 * back from a place in a span to the bytes of the input. */
#ifndef FACCIA_VOICE_PLAN_H
#define FACCIA_VOICE_PLAN_H

#include "server/markup/score.h"
#include "server/voice/faccia-voice.h"

/* A score item inside a span's text. */
struct plan_piece {
    uint32_t span;
    size_t offset, bytes; /* in the span's text */
    size_t from, to;      /* bytes of the input */
    bool verbatim;        /* the text is exactly the input, so places inside map one to one */
};

/* A cue of the score, as far as it lies in the sentence. */
struct plan_cue {
    const char *kind; /* belongs to the plan, as does the name */
    const char *name;
    size_t from, to;                         /* bytes of the input; from == to: a point before what follows */
    double intensity, weight, onset, offset; /* as in score_cue */
    struct score_time delay, duration;
    bool began_before, goes_on;
};

struct plan {
    struct faccia_span *spans; /* strings belong to the plan */
    size_t span_count, span_cap;
    struct plan_piece *pieces; /* in the order of the spans */
    size_t piece_count, piece_cap;
    struct plan_cue *cues;
    size_t cue_count, cue_cap;
    size_t from, to;             /* the sentence's bytes of the input */
    size_t last_bytes, last_cap; /* of the last span's text */
    size_t text_bytes;           /* of all spans */
    double break_seconds;        /* of all breaks */
    char *before, *after;        /* text around it, for voices that are told; NULL = none */
};

/* What multiplies, or stands in for, the styles of the score. */
struct plan_prosody {
    double rate;          /* words per minute, 0 = the voice's own */
    double own_rate;      /* the voice's own words per minute */
    double pitch, volume; /* factors */
    bool chosen;          /* the voice was chosen for the styles' languages: they are not passed on */
    bool plays;           /* the voice plays emotions: they are passed on */
};

/* A whole sentence. Adjacent text items of one style become one span, so that no word is cut. Sounds are left
 * out: their alternate contents are spoken. The plan does not keep the score, whose cues are in their order
 * (score_order_cues). */
void plan_make(struct plan *plan, const struct score *score, size_t sentence,
               const struct plan_prosody *prosody);

/* The same for some items of a sentence, [first, first + count), and without the cues; and the cues of a
 * sentence alone. */
void plan_items(struct plan *plan, const struct score *score, size_t first, size_t count,
                const struct plan_prosody *prosody);
void plan_cues(struct plan *plan, const struct score *score, size_t sentence);

/* Adds the text around some items of a sentence, for a voice with FACCIA_VOICE_CONTEXT. */
enum { PLAN_CONTEXT_BYTES = 400 }; /* on each side */
void plan_context(struct plan *plan, const struct score *score, size_t sentence, size_t first, size_t count);

/* The plan as a voice is told it. Borrowed from both. */
struct faccia_sentence plan_sentence(const struct plan *plan, const char *voice);

/* Tells the voice that the sentence goes on after this plan's text, by a comma at its end: else its tone
 * would fall. */
void plan_go_on(struct plan *plan);

/* The characters of a span's text at that place, in part or whole, as a copy; "" when there are none. */
char *plan_text(const struct plan *plan, uint32_t span, size_t offset, size_t bytes);

void plan_free(struct plan *plan);

/* The input bytes of a piece of a span's text. What lies outside the text is cut off, and both ends are moved
 * outwards to whole characters. False when nothing is left. */
bool plan_locate(const struct plan *plan, uint32_t span, size_t offset, size_t bytes, size_t *from,
                 size_t *to);

#endif
