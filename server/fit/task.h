/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of one articulatory parameter, fitted to all recordings together. */
#ifndef FACCIA_FIT_TASK_H
#define FACCIA_FIT_TASK_H

#include "server/fit/fit.h"

enum { TASK_FOLDS = 8, FOLD_NONE = 255 };

/* A recording in the parameter that is being fitted. */
struct fit_track {
    const struct measured_speech *recording;
    struct phone_segments segments;
    bool *uses;     /* by entry */
    uint8_t *folds; /* by frame: which part of the data it belongs to, or FOLD_NONE: it does not count */
};

/* An entry with the values that the pack gave it. */
struct task_slot {
    const struct fit_entry *entry;
    size_t group;
    struct coefficients plain, stressed;
};

/* What is fitted together. */
struct task {
    const struct speech_pack *pack;
    const struct fit_options *options;
    int param;
    struct fit *fit;
    struct fit_track *tracks;
    size_t track_count;
    struct task_slot *slots; /* by entry */
    const struct speech_group **groups;
    size_t group_count, per_block, frames;
    enum fit_level level;
    size_t *moving; /* the unknowns that may move now: moves.h */
    size_t moving_count;
    double *all; /* every unknown, while those that move are improved */
    double strength;
    int held; /* the fold that is left out, or -1 */
};

void task_open(struct task *task);
void task_close(struct task *task);

/* Fits the parameter from what the pack holds: chooses the level and the strength, then the coefficients. */
void task_fit(struct task *task, void (*choose)(struct task *task));

/* Improves x, all the unknowns, of which those that were chosen move, with the strength and without the fold
 * that is held. The pack then holds what they stand for. */
void task_improve(struct task *task, double *x, int iterations);

/* Makes of a fit x what is written: the part of the way that options say, at the scale that suits best. */
void task_finish(struct task *task, double *x);

/* Sum of squares over the frames of that fold (-1 = of all) as the pack holds it now, and their number. The
 * level of each recording is that of the frames that are not held. */
double task_error(const struct task *task, int fold, size_t *frames);

/* The same over all when each recording has a scale of its own, too: what is wrong with the shape alone. */
double task_shape_error(const struct task *task, size_t *frames);

/* Cross-validation (choice.c): sets level, strength, held_out and held_out_unfitted. */
void task_choose(struct task *task);

#endif
