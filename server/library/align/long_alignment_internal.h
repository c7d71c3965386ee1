/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of a long alignment, shared by its two files. */
#ifndef FACCIA_LIBRARY_ALIGN_LONG_ALIGNMENT_INTERNAL_H
#define FACCIA_LIBRARY_ALIGN_LONG_ALIGNMENT_INTERNAL_H

#include "server/library/align/align.h"
#include "server/library/align/long_alignment.h"
#include "server/library/align/refine.h"
#include "server/library/align/window.h"

enum { PIECES_MAX = 96 };

struct reference_span {
    size_t from, to;      /* bytes of the text */
    uint64_t start, end;  /* samples of the reference */
    size_t phones, words; /* index of the first phone and word */
};

/* Pieces of the text, spoken by the voice. */
struct spoken {
    struct reference_speech speech;
    struct reference_span spans[PIECES_MAX + 1];
    size_t count;
};

struct long_alignment {
    struct window window;
    struct reference *reference;
    const char *text;
    size_t size, at; /* remaining text */
    const atomic_bool *stop;
    bool made, certain;
    const char *voices[2], *chosen; /* chosen: NULL = undecided */
    size_t voice_count;
    double pace;  /* 0 = unknown */
    double other; /* distance of other words; 0 = unknown */
    double until; /* s: everything before has been returned */
    bool found;   /* some of the text was found */
    bool lost;    /* position of the recording in the text is unknown */
    bool likely;  /* all of the window is closer than other words */
    bool failed;  /* the recording contains nothing of the text */
    struct error failure;
    size_t skip; /* samples of the window to skip */
    struct spoken said;
    struct refine_model *model;
    struct long_alignment_piece *ready; /* found, to be returned */
    size_t ready_count, ready_at, ready_cap;
};

/* How the text is cut: seconds of speech at a time, least bytes of a piece. */
struct speak_amount {
    double seconds;
    size_t least;
};
extern const struct speak_amount long_alignment_window;

/* Speaks pieces of the text from c->at on, until the amount is reached. */
int long_alignment_speak(struct long_alignment *c, struct spoken *out, const char *voice,
                         const struct speak_amount *amount, struct error *e);

/* Samples of the reference where the speaker may pause, ascending. Free them. */
uint64_t *long_alignment_pauses(const struct reference_speech *speech, size_t *count);

/* Locates the spoken pieces in the window, extending it if necessary. -1 when the recording is far too
 * short. Free the map in either case. */
int long_alignment_find(struct long_alignment *c, struct align_map *map);

/* At the start: choose the closest voice by the first window, and find where in the window the text
 * begins. */
int long_alignment_choose_voice(struct long_alignment *c, struct error *e);
int long_alignment_choose_start(struct long_alignment *c, struct error *e);

/* Where a piece of the text was aligned. */
struct fit {
    const struct align_map *map;
    const struct window *window;
    const struct spoken *said;
    uint64_t from;               /* sample of the reference at which the map begins */
    size_t base;                 /* window offset */
    struct refine_phone *phones; /* placed more closely; NULL = only the map knows */
    size_t phone_count;
    bool heard; /* the recogniser has heard the recording */
};

/* Places the phones of the spans from..to more closely. Free fit->phones. */
void long_alignment_refine(struct long_alignment *c, struct fit *fit, const struct reference_span *from,
                           const struct reference_span *to);

/* Mean log probability of the classes of sounds between two samples of the reference, where they were placed:
 * 0 at most. Measured: -1.8 to -0.7 for words that are said there (-2.6 in noise), -3.3 to -2.3 for others.
 */
double long_alignment_heard(const struct fit *fit, uint64_t from, uint64_t to);

/* Queue a located piece, with its distance relative to other words, or a piece that was not located. */
void long_alignment_take(struct long_alignment *c, const struct fit *fit, const struct reference_span *span,
                         double apart);
void long_alignment_miss(struct long_alignment *c, const struct reference_span *span);

bool long_alignment_stopped(const struct long_alignment *c);
int long_alignment_cancelled(struct error *e);
int long_alignment_misfit(const struct long_alignment *c, size_t byte, double time, const char *why,
                          struct error *e);

#endif
