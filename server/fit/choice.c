/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of a pack may move, and how strongly the fit is held to it: as foretells what has not been seen
 * (cross-validation), by the rule of one standard error (Breiman, Friedman, Olshen and Stone, "Classification
 * and regression trees", 1984, 3.4.3): of all that was tried, from the pack as it was over few moves firmly
 * held to many loosely held, the first whose error is above the least one by no more than one standard error
 * of what the least one gains over the pack. So a gain that may be chance changes nothing, and one that is
 * hardly more than chance changes little. */
#include "server/base/mem.h"
#include "server/fit/moves.h"
#include "server/fit/task.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* mm of error that a move by one spread is weighed against, from firm to loose. */
static const double strengths[] = {12, 6, 3, 1.2, 0.4, 0.12};
enum {
    STRENGTHS = sizeof strengths / sizeof *strengths,
    TRIALS = 1 + (FIT_LEVELS - 1) * STRENGTHS,
    WORSE = 2
};

struct trial {
    enum fit_level level;
    double strength;
    double errors[TASK_FOLDS]; /* sum of squares of each held-out part, mm^2 */
    double sum;
};

/* A state of all unknowns for each fold. */
static double *state(const struct task *task, double *x, int fold) {
    return x + (size_t)fold * moves_count(task);
}

/* What is judged is what would be written. */
static void run_trial(struct task *task, double *x, int iterations, struct trial *trial,
                      size_t frames[TASK_FOLDS]) {
    size_t size = moves_count(task) * sizeof *x;
    double *written = mem_alloc(size);
    trial->level = task->level;
    trial->strength = task->strength;
    trial->sum = 0;
    for (task->held = 0; task->held < TASK_FOLDS; task->held++) {
        task_improve(task, state(task, x, task->held), iterations);
        memcpy(written, state(task, x, task->held), size);
        task_finish(task, written);
        trial->errors[task->held] = task_error(task, task->held, &frames[task->held]);
        trial->sum += trial->errors[task->held];
    }
    task->held = -1;
    free(written);
}

/* Of the gain's sum, over the parts as clusters. Infinite where there are too few of them to tell. */
static double standard_error(const struct trial *before, const struct trial *after,
                             const size_t frames[TASK_FOLDS]) {
    double all = 0, parts = 0, squares = 0, gain = before->sum - after->sum;
    for (int i = 0; i < TASK_FOLDS; i++) {
        all += (double)frames[i];
        parts += frames[i] > 0;
    }
    if (parts < 3)
        return INFINITY;
    for (int i = 0; i < TASK_FOLDS; i++) {
        double off = before->errors[i] - after->errors[i] - gain * (double)frames[i] / all;
        squares += off * off;
    }
    return sqrt(squares * parts / (parts - 1));
}

/* Whole recordings alone can tell of each phone's own target, and of shapes: they contain the phone again. */
static enum fit_level last_level(const struct task *task) {
    return task->track_count >= TASK_FOLDS ? FIT_PHONES : FIT_GROUPS;
}

/* Each strength begins at the firmer one's coefficients. Returns how many were tried. */
static size_t try_level(struct task *task, enum fit_level level, const double *start, struct trial *trials,
                        size_t frames[TASK_FOLDS]) {
    size_t size = TASK_FOLDS * moves_count(task) * sizeof *start, best = 0, i;
    double *x = mem_alloc(size);
    memcpy(x, start, size);
    task->level = level;
    moves_choose(task, level);
    for (i = 0; i < STRENGTHS && i - best <= WORSE; i++) {
        task->strength = strengths[i];
        run_trial(task, x, task->options->first, &trials[i], frames);
        if (trials[i].sum < trials[best].sum)
            best = i;
    }
    free(x);
    return i;
}

void task_choose(struct task *task) {
    struct trial trials[TRIALS];
    size_t frames[TASK_FOLDS], count = 1, best = 0, chosen = 0, all = 0;
    double *x = mem_alloc(TASK_FOLDS * moves_count(task) * sizeof *x);
    task->strength = INFINITY;
    task->level = FIT_SCALE;
    moves_choose(task, FIT_SCALE);
    run_trial(task, x, task->options->then, &trials[0], frames);
    if (task->options->strength > 0) {
        task->strength = task->options->strength;
        task->level = FIT_PHONES;
        moves_choose(task, FIT_PHONES);
        run_trial(task, x, task->options->first, &trials[1], frames);
        chosen = 1;
    } else {
        for (enum fit_level level = FIT_KINDS; level <= last_level(task); level++)
            count += try_level(task, level, x, &trials[count], frames);
        for (size_t i = 1; i < count; i++)
            if (trials[i].sum < trials[best].sum)
                best = i;
        double most = trials[best].sum + standard_error(&trials[0], &trials[best], frames);
        while (trials[chosen].sum > most)
            chosen++;
    }
    for (int i = 0; i < TASK_FOLDS; i++)
        all += frames[i];
    task->level = trials[chosen].level;
    task->strength = trials[chosen].strength;
    task->fit->held_out[task->param] = sqrt(trials[chosen].sum / (double)(all ? all : 1));
    task->fit->held_out_unfitted[task->param] = sqrt(trials[0].sum / (double)(all ? all : 1));
    free(x);
}
