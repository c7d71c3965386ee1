/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/life/life_shift.h"
#include "server/base/mem.h"
#include "server/face/life/life_random.h"
#include <stdlib.h>

#define BLOCK_SECONDS 20.0
#define EDGE_SPREAD 8.0

/* Posture: how often it changes and how far it goes, degrees (standard deviations). */
#define POSE_MEDIAN 5.5
#define POSE_DEVIATION 0.6
#define POSE_PITCH 0.8
#define POSE_YAW 1.3
#define POSE_ROLL 1.0
#define POSE_SHORTEST 1.0

void shifts_add(struct shifts *shifts, const struct shift *shift) {
    shifts->items = mem_grow(shifts->items, &shifts->cap, shifts->count + 1, sizeof *shift);
    shifts->items[shifts->count++] = *shift;
}

void shifts_free(struct shifts *shifts) {
    free(shifts->items);
    *shifts = (struct shifts){0};
}

size_t shifts_find(struct shifts *shifts, double clock) {
    size_t i = shifts->cursor;
    while (i && shifts->items[i].at > clock)
        i--;
    while (i + 1 < shifts->count && shifts->items[i + 1].at <= clock)
        i++;
    return shifts->cursor = i;
}

/* What is still to be gone of the way that began `since` seconds ago. */
static double rest(double since, double length) {
    return since < length ? 1 - life_smooth(since / length) : 0;
}

void shifts_at(struct shifts *shifts, double clock, double out[SHIFT_CHANNELS]) {
    size_t i = shifts_find(shifts, clock);
    for (int c = 0; c < SHIFT_CHANNELS; c++)
        out[c] += (double)shifts->items[i].to[c];
    for (; i && clock - shifts->items[i].at < SHIFT_LONGEST; i--) {
        const struct shift *s = &shifts->items[i];
        double eyes = rest(clock - s->at, (double)s->fast), head = rest(clock - s->at, (double)s->slow);
        for (int c = 0; eyes > 0 && c < SHIFT_EYES; c++)
            out[c] -= eyes * (double)(s->to[c] - s[-1].to[c]);
        for (int c = SHIFT_EYES; head > 0 && c < SHIFT_CHANNELS; c++)
            out[c] -= head * (double)(s->to[c] - s[-1].to[c]);
    }
}

double life_edge(uint64_t seed, int64_t block) {
    struct dice d = dice_of(seed, DICE_EDGE, block);
    return BLOCK_SECONDS * (double)block + EDGE_SPREAD * (dice_roll(&d) - 0.5);
}

int64_t life_block(uint64_t seed, double clock) {
    int64_t block = (int64_t)floor(clock / BLOCK_SECONDS);
    if (clock < life_edge(seed, block))
        return block - 1;
    return clock < life_edge(seed, block + 1) ? block : block + 1;
}

void poses_of_block(struct shifts *poses, uint64_t seed, int64_t block) {
    struct dice d = dice_of(seed, DICE_POSES, block);
    double at = life_edge(seed, block), end = life_edge(seed, block + 1) - SHIFT_LONGEST;
    shifts_add(poses, &(struct shift){.at = at});
    for (;;) {
        at += fmax(dice_log_normal(&d, POSE_MEDIAN, POSE_DEVIATION), SHIFT_LONGEST);
        struct shift s = {.at = fmin(at, end), .slow = (float)dice_between(&d, POSE_SHORTEST, SHIFT_LONGEST)};
        if (at + SHIFT_LONGEST < end) {
            s.to[HEAD_PITCH] = (float)(POSE_PITCH * dice_normal(&d));
            s.to[HEAD_YAW] = (float)(POSE_YAW * dice_normal(&d));
            s.to[HEAD_ROLL] = (float)(POSE_ROLL * dice_normal(&d));
            shifts_add(poses, &s);
        } else {
            s.at = end;
            shifts_add(poses, &s);
            return;
        }
    }
}
