/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound that comes from somebody else's clock, on its way to ours. What has come waits here until it is
 * taken.
 *
 * How fast that clock runs is measured: every JITTER_WINDOW seconds, by how much more or less than that came
 * over the last windows, in the moments of each in which most had come (what is late on its way says nothing
 * of a clock); less than JITTER_TOLERANCE is none. Sound is read as much faster or slower, its pitch with it,
 * and so much besides that within JITTER_SETTLE seconds as much is on its way as at the beginning,
 * JITTER_WAIT seconds at most, give or take JITTER_TOLERANCE; never by more than JITTER_MAX in all. Else it
 * is left as it is, to the bit.
 *
 * Where more waits than may, all but the last JITTER_KEEP seconds are left out: who is that far ahead does
 * not speak, but send. */
#ifndef FACCIA_SYNTHESIS_JITTER_BUFFER_H
#define FACCIA_SYNTHESIS_JITTER_BUFFER_H

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
    size_t most; /* samples that may wait */
    int16_t *samples;
    size_t first, count, cap; /* that wait are count, from first on; the one before them is still needed */
    double between;           /* where the next one lies after the first, 0 to 1 */
    double speed;             /* by how much faster than as it is sound is read */

    /* of the clock, since it was last begun */
    double begun, window, wanted;   /* s; negative: not yet */
    uint64_t came, taken;           /* samples */
    double most_came, most_ahead;   /* in this window, s beyond the time that has passed */
    double history[JITTER_WINDOWS]; /* most_came of the last ones, the newest last */
    unsigned windows;
};

void jitter_buffer_open(struct jitter_buffer *buffer, unsigned rate, size_t most);
void jitter_buffer_free(struct jitter_buffer *buffer);

/* Samples have come, at that time in s. Returns how many that waited were left out. */
size_t jitter_buffer_add(struct jitter_buffer *buffer, const int16_t *samples, size_t count, double now);

/* Takes up to so many; returns how many. */
size_t jitter_buffer_take(struct jitter_buffer *buffer, int16_t *samples, size_t count);

/* All but the last JITTER_KEEP seconds is left out; returns how many samples. */
size_t jitter_buffer_catch_up(struct jitter_buffer *buffer);

/* What comes next says nothing of what came before: the clock is measured anew. */
void jitter_buffer_begin(struct jitter_buffer *buffer);

#endif
