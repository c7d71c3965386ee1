/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a face does while it lives, counted as an observer with a camera would: from the FAPs alone. */
#ifndef FACCIA_EVAL_LIFE_STATISTICS_H
#define FACCIA_EVAL_LIFE_STATISTICS_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>

/* Looking at the listener: no further than this from straight ahead, degrees. */
#define LIFE_LISTENER_DEGREES 4.0

struct life_list {
    double *items;
    size_t count, cap;
};

/* Angles in degrees, speeds in degrees a second, times in s. */
struct life_statistics {
    double fps;
    size_t frames;
    struct life_list intervals, durations; /* of blinks: start to start; while the lids are away from where
                                              they follow the gaze */
    size_t blinks, incomplete;
    struct life_list saccades;                 /* sizes of those of half a degree and more */
    struct life_list away;                     /* how long glances away from the listener last */
    size_t at_listener;                        /* frames */
    double low[3], high[3], sum[3], square[3]; /* head pitch, yaw, roll */
    double speed[3], acceleration[3];          /* the highest */
    /* What the counting needs between frames. */
    double head[3], velocity[3], gaze[2], jump[2], since_blink, blink_from, away_from, deepest;
    bool closed, jumping;
};

void life_statistics_init(struct life_statistics *s, double fps);
void life_statistics_free(struct life_statistics *s);

/* The next frame; at least 100 a second see saccades and blinks as they are. */
void life_statistics_add(struct life_statistics *s, const struct fap_frame *frame);

/* 0 when there is none. */
double life_list_mean(const struct life_list *list);
double life_list_deviation(const struct life_list *list);
/* Skewness: above 0 for a long tail of large values. */
double life_list_skewness(const struct life_list *list);

#endif
