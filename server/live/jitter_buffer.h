/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A jitter buffer for sound from another clock.
 * The clock's drift is measured every JITTER_WINDOW seconds, from the surplus of samples over the last
 * windows at the moments when most had arrived (network delay says nothing about a clock); less than
 * JITTER_TOLERANCE counts as none. Playback is resampled, pitch included, to follow the drift and to return
 * within JITTER_SETTLE seconds to the initial fill level, at most JITTER_WAIT seconds, within
 * JITTER_TOLERANCE; never by more than JITTER_MAX in all. Otherwise the samples pass unchanged. When the
 * buffer is full, all but the last JITTER_KEEP seconds are dropped: a sender that far ahead is not live. */
#ifndef FACCIA_LIVE_JITTER_BUFFER_H
#define FACCIA_LIVE_JITTER_BUFFER_H

#include <stddef.h>
#include <stdint.h>

#define JITTER_WINDOW 2.0
#define JITTER_SETTLE 8.0
#define JITTER_WAIT 0.2
#define JITTER_KEEP 0.2
#define JITTER_MAX 0.05
#define JITTER_TOLERANCE 0.025
enum { JITTER_WINDOWS = 5 };

struct jitter_buffer {
    unsigned rate;
    size_t most; /* capacity, in samples */
    int16_t *samples;
    size_t first, count, cap; /* waiting samples: count, starting at first; the one before is still needed */
    double between;           /* fractional position between the first and the next, 0 to 1 */
    double speed;             /* playback speed minus 1 */

    /* the sender's clock, since the last jitter_buffer_begin */
    double begun, window, wanted;   /* s; negative: not set */
    uint64_t came, taken;           /* samples */
    double most_came, most_ahead;   /* in this window, s beyond the time passed */
    double history[JITTER_WINDOWS]; /* most_came of previous windows, newest last */
    unsigned windows;
};

void jitter_buffer_open(struct jitter_buffer *buffer, unsigned rate, size_t most);
void jitter_buffer_free(struct jitter_buffer *buffer);

/* Adds samples that arrived at `now`, in s. Returns the number of waiting samples dropped. */
size_t jitter_buffer_add(struct jitter_buffer *buffer, const int16_t *samples, size_t count, double now);

/* Takes up to count samples; returns how many. */
size_t jitter_buffer_take(struct jitter_buffer *buffer, int16_t *samples, size_t count);

/* Drops all but the last JITTER_KEEP seconds; returns the number of samples. */
size_t jitter_buffer_catch_up(struct jitter_buffer *buffer);

/* Restarts the clock measurement after a gap. */
void jitter_buffer_begin(struct jitter_buffer *buffer);

#endif
