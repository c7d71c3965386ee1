/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A window that slides over a recording of any length: what is worked on is in memory, without the middle of
 * long pauses. */
#ifndef FACCIA_ALIGN_WINDOW_H
#define FACCIA_ALIGN_WINDOW_H

#include "server/align/sound_file.h"
#include <stdbool.h>

enum { WINDOW_LEVELS = 100 }; /* dB */

/* From sample `here` of the window on, it is the recording from sample `there` on. */
struct window_piece {
    size_t here;
    uint64_t there;
};

struct window {
    const struct sound_source *source; /* borrowed */
    int16_t *pcm;
    size_t samples, cap;
    struct window_piece *pieces;
    size_t piece_count, piece_cap;
    uint64_t next;   /* sample of the recording that comes after the window */
    uint64_t judged; /* up to where levels has been counted */
    uint64_t levels[WINDOW_LEVELS];
    size_t silent; /* frames of silence at the window's end */
    bool ended;    /* the recording has no more */
};

void window_open(struct window *w, const struct sound_source *source);
void window_close(struct window *w);
struct window window_copy(const struct window *w); /* which goes on by itself */

/* Reads on until the window has so many samples, or the recording ends. */
void window_fill(struct window *w, size_t samples);

/* Drops the samples before that one. */
void window_drop(struct window *w, size_t sample);

/* The sample of the recording that a sample of the window is. */
uint64_t window_place(const struct window *w, size_t sample);

/* The sample at which the next pause of half a second or more that begins at or after `from` ends, or
 * SIZE_MAX. */
size_t window_after_pause(const struct window *w, size_t from);

/* How long, in seconds, the recording sounds between two of its samples; more than `enough` is not counted.
 */
double window_sounds(struct window *w, uint64_t from, uint64_t to, double enough);

#endif
