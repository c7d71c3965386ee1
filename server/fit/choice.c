/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How strongly a fit is held to the pack that it starts from: as foretells best what has not been seen
 * (cross-validation). Where there are few recordings, stretches of them are held out instead of whole ones,
 * and those are alike: what foretells them best knows the speaker too well. Then it is the firmest strength
 * that gains a third of what the best one gains over the unfitted pack. (Between two speakers, fitted to one
 * and measured on the other, one standard error, the usual rule, was too loose for some parameters and left
 * others unfitted.) */
#include "server/base/mem.h"
#include "server/fit/task.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* mm of error that a move by one spread is weighed against, from firm to loose; before them comes no move at
 * all. */
static const double strengths[] = {12, 6, 3, 1.2, 0.4, 0.12};
enum { STRENGTHS = sizeof strengths / sizeof *strengths, WORSE = 2 };

struct trial {
    double errors[TASK_FOLDS]; /* mean square of each held-out part, mm^2 */
    double mean;
};

static void mean_of(struct trial *trial, const size_t frames[TASK_FOLDS]) {
    double sum = 0, n = 0;
    for (int fold = 0; fold < TASK_FOLDS; fold++) {
        sum += trial->errors[fold] * (double)frames[fold];
        n += (double)frames[fold];
    }
    trial->mean = n > 0 ? sum / n : 0;
}

static void run_trial(struct task *task, double *x, size_t each, int iterations, struct trial *trial,
                      size_t frames[TASK_FOLDS]) {
    for (int fold = 0; fold < TASK_FOLDS; fold++) {
        task->held = fold;
        task_apply(task, x + (size_t)fold * each);
        if (iterations) /* a looser fit begins at the firmer one */
            task_improve(task, x + (size_t)fold * each, iterations);
        double sum = task_error(task, fold, &frames[fold]);
        trial->errors[fold] = frames[fold] ? sum / (double)frames[fold] : 0;
    }
    task->held = -1;
    mean_of(trial, frames);
}

void task_choose(struct task *task) {
    struct trial trials[STRENGTHS + 1];
    double own = task->options->strength, *x = mem_alloc(TASK_FOLDS * task_unknowns(task) * sizeof *x);
    const double *list = own > 0 ? &own : strengths;
    size_t frames[TASK_FOLDS], each = task_unknowns(task), best = 0, most = own > 0 ? 1 : STRENGTHS;
    task->strength = INFINITY;
    run_trial(task, x, each, 0, &trials[0], frames);
    for (size_t i = 1; i <= most && i - best <= WORSE + 1; i++) {
        task->strength = list[i - 1];
        run_trial(task, x, each, task->options->first, &trials[i], frames);
        if (trials[i].mean < trials[best].mean)
            best = i;
    }
    size_t chosen = own > 0 ? 1 : best;
    while (chosen > 1 && task->track_count < TASK_FOLDS &&
           trials[0].mean - trials[chosen - 1].mean >= (trials[0].mean - trials[best].mean) / 3)
        chosen--;
    task->strength = chosen ? list[chosen - 1] : INFINITY;
    task->fit->held_out[task->param] = sqrt(trials[chosen].mean);
    task->fit->held_out_unfitted[task->param] = sqrt(trials[0].mean);
    free(x);
}
