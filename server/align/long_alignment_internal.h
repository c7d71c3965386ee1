/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inside of a long alignment: what is looked for next, and where. */
#ifndef FACCIA_ALIGN_LONG_ALIGNMENT_INTERNAL_H
#define FACCIA_ALIGN_LONG_ALIGNMENT_INTERNAL_H

#include "server/align/align.h"
#include "server/align/long_alignment.h"
#include "server/align/window.h"

enum { PIECES_MAX = 64 };

struct reference_span {
    size_t from, to;      /* bytes of the text */
    uint64_t start, end;  /* samples of the reference */
    size_t phones, words; /* the first of each */
};

struct long_alignment {
    struct window window;
    struct reference *reference;
    const char *text;
    size_t size, at; /* the text that is to come */
    const atomic_bool *stop;
    bool made;
    const char *voices[2];
    size_t voice_count;
    double pace; /* 0 = not known yet */
    size_t skip; /* samples of the window that are passed over */
    struct reference_speech speech;
    struct reference_span spans[PIECES_MAX + 1];
    size_t span_count;
    struct long_alignment_piece *ready; /* found and not yet handed out */
    size_t ready_count, ready_at, ready_cap;
};

/* Has the voice speak pieces of the text from alignment->at on, until there are enough. */
int long_alignment_speak(struct long_alignment *c, const char *voice, struct error *e);

/* Looks for what the voice has spoken in the window, which is made longer if need be. -1 when the recording
 * is far too short. Free the map in any case. */
int long_alignment_find(struct long_alignment *c, struct align_map *map);

/* At the beginning: which of the voices comes closest, by what it makes of the first window (then it is
 * voices[0], alone); where in the window the text begins. */
int long_alignment_choose_voice(struct long_alignment *c, struct error *e);
int long_alignment_choose_start(struct long_alignment *c, struct error *e);

bool long_alignment_stopped(const struct long_alignment *c);
int long_alignment_cancelled(struct error *e);

#endif
