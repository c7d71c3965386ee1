/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of idle movement, from FAPs only, as an observer with a camera would count. */
#ifndef FACCIA_RESEARCH_LIFE_STATISTICS_H
#define FACCIA_RESEARCH_LIFE_STATISTICS_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>

/* Gaze within this angle of straight ahead looks at the listener, degrees. */
#define LIFE_LISTENER_DEGREES 4.0

struct life_list {
    double *items;
    size_t count, cap;
};

/* Angles in degrees, speeds in degrees per second, times in s. */
struct life_statistics {
    double fps;
    size_t frames;
    struct life_list intervals, durations; /* of blinks: from start to start; time for which the lids differ
                                              from where the gaze puts them */
    size_t blinks, incomplete;
    struct life_list saccades;                 /* sizes of saccades of at least half a degree */
    struct life_list away;                     /* durations of glances away from the listener */
    size_t at_listener;                        /* frames */
    double low[3], high[3], sum[3], square[3]; /* head pitch, yaw, roll */
    double speed[3], acceleration[3];          /* maximum */
    /* State between frames. */
    double head[3], velocity[3], gaze[2], jump[2], since_blink, blink_from, away_from, deepest;
    bool closed, jumping;
};

void life_statistics_init(struct life_statistics *s, double fps);
void life_statistics_free(struct life_statistics *s);

/* Adds a frame; saccades and blinks need at least 100 frames per second. */
void life_statistics_add(struct life_statistics *s, const struct fap_frame *frame);

/* 0 when the list is empty. */
double life_list_mean(const struct life_list *list);
double life_list_deviation(const struct life_list *list);
/* Skewness: positive for a long tail of large values. */
double life_list_skewness(const struct life_list *list);

#endif
