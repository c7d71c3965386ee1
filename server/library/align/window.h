/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A window that slides over a recording of any length and keeps it in memory, without the middle of long
 * pauses. */
#ifndef FACCIA_LIBRARY_ALIGN_WINDOW_H
#define FACCIA_LIBRARY_ALIGN_WINDOW_H

#include "server/library/align/sound/sound_file.h"
#include <stdbool.h>

enum { WINDOW_LEVELS = 100 }; /* dB */

/* From sample `here` of the window on, it holds the recording from sample `there` on. */
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
    uint64_t next;   /* next sample of the recording to read */
    uint64_t judged; /* sample up to which `levels` is complete */
    uint64_t levels[WINDOW_LEVELS];
    size_t silent; /* frames of silence at the window's end */
    bool ended;    /* the end of the recording was reached */
};

void window_open(struct window *w, const struct sound_source *source);
void window_close(struct window *w);
struct window window_copy(const struct window *w); /* an independent copy */

/* Reads until the window has that many samples or the recording ends. */
void window_fill(struct window *w, size_t samples);

/* Drops samples before that one. */
void window_drop(struct window *w, size_t sample);

/* Maps a sample of the window to the recording. */
uint64_t window_place(const struct window *w, size_t sample);

/* End of the next pause of at least half a second that begins at or after `from`, or SIZE_MAX. */
size_t window_after_pause(const struct window *w, size_t from);

/* Seconds of sound, without silence, between two samples of the recording; stops counting at `enough`. */
double window_sounds(struct window *w, uint64_t from, uint64_t to, double enough);

#endif
