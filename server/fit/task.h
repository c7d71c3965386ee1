/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of one articulatory parameter, fitted to all recordings together. */
#ifndef FACCIA_FIT_TASK_H
#define FACCIA_FIT_TASK_H

#include "server/fit/fit.h"

enum { TASK_FOLDS = 5, FOLD_NONE = 255 };

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
    size_t group; /* its group's block of unknowns */
    struct coefficients plain, stressed;
};

/* What is fitted together: blocks of unknowns. The first is the speaker's: it moves all phones alike, and
 * multiplies their targets. Then one for each group, which moves its phones alike, and one for each entry,
 * which moves its target besides. */
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
    double strength;
    int held; /* the fold that is left out, or -1 */
    int iterations_before;
};

void task_open(struct task *task);
void task_close(struct task *task);

/* Fits the parameter from what the pack holds: chooses the strength, then the coefficients. */
void task_fit(struct task *task, void (*choose)(struct task *task));

/* Their unknowns, and the way from x to what the pack then holds. */
size_t task_unknowns(const struct task *task);
void task_apply(const struct task *task, const double *x);

/* Improves x with the strength and without the fold that is held. */
void task_improve(struct task *task, double *x, int iterations);

/* Sum of squares over the frames of that fold (-1 = of all) as the pack holds it now, and their number. The
 * level of each recording is that of the frames that are not held. */
double task_error(const struct task *task, int fold, size_t *frames);

/* Cross-validation (choice.c): sets strength, held_out and unfitted. */
void task_choose(struct task *task);

#endif
