/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coefficients as unconstrained unknowns: x is the distance of a value from the pack's, mapped into the
 * limits of anatomy and of a speech pack, so that the solver may step anywhere. */
#ifndef FACCIA_RESEARCH_FIT_INTERNAL_H
#define FACCIA_RESEARCH_FIT_INTERNAL_H

#include "server/face/engines/targets.h"
#include "server/research/fit.h"

/* Fitted coefficients of a segment: all but k, which affects the curve only when it crosses
 * DOMINANCE_RESISTANT and thus has no gradient. The original function has no shape and only one c. */
enum { UNKNOWNS_LOOK_AHEAD = 11, UNKNOWNS_ORIGINAL = 6, UNKNOWNS_MOST = UNKNOWNS_LOOK_AHEAD };

/* The first ones, t and T, are specific to a phone and context; the others are shared by its group. */
enum { UNKNOWNS_TARGET = 2, UNKNOWNS_T = 1 };

/* One articulatory parameter, fitted to all recordings together. */

enum { TASK_FOLDS = 8, FOLD_NONE = 255 };

/* A recording of the parameter being fitted. */
struct fit_track {
    const struct measured_speech *recording;
    struct phone_segments segments;
    bool *uses;     /* by entry */
    uint8_t *folds; /* by frame: its fold, or FOLD_NONE if it does not count */
};

/* An entry with the pack's original values. */
struct task_slot {
    const struct fit_entry *entry;
    size_t group;
    struct coefficients plain, stressed;
};

/* State of a fit. */
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
    size_t *moving; /* unknowns that may change */
    size_t moving_count;
    double *all; /* all unknowns, while some of them are improved */
    double strength;
    int held; /* fold that is held out, or -1 */
};

void task_open(struct task *task);
void task_close(struct task *task);

/* Fits the parameter from the pack's values: chooses level and strength, then the coefficients. */
void task_fit(struct task *task, void (*choose)(struct task *task));

/* Improves x (all unknowns, of which the chosen ones change) with the current strength, without the
 * held-out fold. Applies x to the pack. */
void task_improve(struct task *task, double *x, int iterations);

/* Converts a fit x to the result: the requested part of the way, at the best scale. */
void task_finish(struct task *task, double *x);

/* Sum of squares over the frames of a fold (-1 = all) for the pack's current values, and their number.
 * Each recording's level comes from the frames that are not held out. */
double task_error(const struct task *task, int fold, size_t *frames);

/* The same over all frames with a free scale for each recording: error of the shape alone. */
double task_shape_error(const struct task *task, size_t *frames);

/* Gets the curve F that task_shape_error compares with a recording, NAN at frames that do not count. */
void task_shape(const struct task *task, const struct fit_track *t, double *out);

/* The fold of each frame in cross-validation: whole recordings if there are at least TASK_FOLDS. Otherwise
 * phones: all occurrences of a phone are in one fold, so that its prediction is learnt from other phones.
 * Folds of contiguous time would be predicted by other phones of the same words, and by a fit that knows only
 * this sentence. */

/* Makes the folds of all tracks, which own them. Pauses count only if rest_known. */
void folds_make(struct fit_track *tracks, size_t count, bool rest_known);

/* The parameters of a fit, from those shared by all phones down to those of one phone, and their effect on a
 * pack. All unknowns: the logarithm of the scale of all movements; a block for the consonants and one for the
 * vowels; one block per viseme group; and for each entry its target. A phone's coefficients are changed by
 * the sum of its blocks, and its target is multiplied by the scale. */

/* Returns the number of unknowns, and selects those that may change at a level (into task->moving). */
size_t moves_count(const struct task *task);
void moves_choose(struct task *task, enum fit_level level);

#endif
