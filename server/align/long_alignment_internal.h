/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inside of a long alignment: what is looked for next, and where. */
#ifndef FACCIA_ALIGN_LONG_ALIGNMENT_INTERNAL_H
#define FACCIA_ALIGN_LONG_ALIGNMENT_INTERNAL_H

#include "server/align/align.h"
#include "server/align/long_alignment.h"
#include "server/align/window.h"

enum { PIECES_MAX = 96 };

struct reference_span {
    size_t from, to;      /* bytes of the text */
    uint64_t start, end;  /* samples of the reference */
    size_t phones, words; /* the first of each */
};

/* Pieces of the text as the voice speaks them. */
struct spoken {
    struct reference_speech speech;
    struct reference_span spans[PIECES_MAX + 1];
    size_t count;
};

struct long_alignment {
    struct window window;
    struct reference *reference;
    const char *text;
    size_t size, at; /* the text that is to come */
    const atomic_bool *stop;
    bool made;
    const char *voices[2], *chosen; /* chosen: NULL = not yet */
    size_t voice_count;
    double pace;  /* 0 = not known yet */
    double other; /* the distance of other words; 0 = not known yet */
    double until; /* s: what is before has been handed out */
    bool found;   /* some of the text has been */
    bool lost;    /* where the recording is in the text */
    bool likely;  /* all of the window is nearer than other words */
    bool failed;  /* nothing of the text is in it: */
    struct error failure;
    size_t skip; /* samples of the window that are passed over */
    struct spoken said;
    struct long_alignment_piece *ready; /* found and not yet handed out */
    size_t ready_count, ready_at, ready_cap;
};

/* How the text is cut, and how much of it is spoken: seconds of speech, the least bytes of a piece. */
struct speak_amount {
    double seconds;
    size_t least;
};
extern const struct speak_amount long_alignment_window;

/* Has the voice speak pieces of the text from c->at on, until there are enough. */
int long_alignment_speak(struct long_alignment *c, struct spoken *out, const char *voice,
                         const struct speak_amount *amount, struct error *e);

/* Where the speaker may pause: samples of the reference, in order; to be freed. */
uint64_t *long_alignment_pauses(const struct reference_speech *speech, size_t *count);

/* Looks for what the voice has spoken in the window, which is made longer if need be. -1 when the recording
 * is far too short. Free the map in any case. */
int long_alignment_find(struct long_alignment *c, struct align_map *map);

/* At the beginning: which of the voices comes closest, by what it makes of the first window; where in the
 * window the text begins. */
int long_alignment_choose_voice(struct long_alignment *c, struct error *e);
int long_alignment_choose_start(struct long_alignment *c, struct error *e);

/* Where a piece of the text was aligned. */
struct fit {
    const struct align_map *map;
    const struct window *window;
    const struct spoken *said;
    uint64_t from; /* sample of the reference at which the map begins */
    size_t base;   /* of the window */
};
double fit_time(const struct fit *fit, uint64_t sample); /* s of the recording */

/* Hands out a piece that was found there, apart of other words' distance; one that was not found. */
void long_alignment_take(struct long_alignment *c, const struct fit *fit, const struct reference_span *span,
                         double apart);
void long_alignment_miss(struct long_alignment *c, const struct reference_span *span);

/* Text and recording seem to differ: looks for what comes next of both, in a stretch of each. 1: what was
 * found, and what was not, is ready, and the window is behind it. 0: all of the text up to that byte is
 * there, one after the other. -1 with *e. */
int long_alignment_recover(struct long_alignment *c, size_t until, struct error *e);

bool long_alignment_stopped(const struct long_alignment *c);
int long_alignment_cancelled(struct error *e);
int long_alignment_misfit(const struct long_alignment *c, size_t byte, double time, const char *why,
                          struct error *e);

#endif
