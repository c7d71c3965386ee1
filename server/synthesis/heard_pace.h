/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound that comes from somebody else's clock, on its way to ours. What has come waits here until it is
 * taken.
 *
 * How fast that clock runs is measured: every PACE_WINDOW seconds, by how much more or less than that came
 * over the last windows, in the moments of each in which most had come (what is late on its way says nothing
 * of a clock); less than PACE_BLUR is none. Sound is read as much faster or slower, its pitch with it, and so
 * much besides that within PACE_SETTLE seconds as much is on its way as at the beginning, PACE_WAIT seconds
 * at most, give or take PACE_BLUR; never by more than PACE_MOST in all. Else it is left as it is, to the bit.
 *
 * Where more waits than may, all but the last PACE_KEEP seconds are left out: who is that far ahead does not
 * speak, but send. */
#ifndef FACCIA_SYNTHESIS_HEARD_PACE_H
#define FACCIA_SYNTHESIS_HEARD_PACE_H

#include <stddef.h>
#include <stdint.h>

#define PACE_WINDOW 2.0
#define PACE_SETTLE 8.0
#define PACE_WAIT 0.2
#define PACE_KEEP 0.2
#define PACE_MOST 0.05
#define PACE_BLUR 0.025
enum { PACE_WINDOWS = 5 };

struct heard_pace {
    unsigned rate;
    size_t most; /* samples that may wait */
    int16_t *samples;
    size_t first, count, cap; /* that wait are count, from first on; the one before them is still needed */
    double between;           /* where the next one lies after the first, 0 to 1 */
    double speed;             /* by how much faster than as it is sound is read */

    /* of the clock, since it was last begun */
    double begun, window, wanted; /* s; negative: not yet */
    uint64_t came, taken;         /* samples */
    double most_came, most_ahead; /* in this window, s beyond the time that has passed */
    double history[PACE_WINDOWS]; /* most_came of the last ones, the newest last */
    unsigned windows;
};

void heard_pace_open(struct heard_pace *pace, unsigned rate, size_t most);
void heard_pace_free(struct heard_pace *pace);

/* Samples have come, at that time in s. Returns how many that waited were left out. */
size_t heard_pace_add(struct heard_pace *pace, const int16_t *samples, size_t count, double now);

/* Takes up to so many; returns how many. */
size_t heard_pace_take(struct heard_pace *pace, int16_t *samples, size_t count);

/* All but the last PACE_KEEP seconds is left out; returns how many samples. */
size_t heard_pace_catch_up(struct heard_pace *pace);

/* What comes next says nothing of what came before: the clock is measured anew. */
void heard_pace_begin(struct heard_pace *pace);

#endif
