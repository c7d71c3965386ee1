/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/task.h"
#include "server/base/mem.h"
#include "server/fit/least_squares.h"
#include "server/fit/unknowns.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Step of the numerical slopes, in unknowns. */
#define STEP 1e-4
/* Pull of every unknown towards its start, mm: far below the noise of any recording, it only decides what the
 * data leave open, such as the common scale of all alphas. */
#define PULL 0.02
/* A phone's resistance is changed only where Z shrinks at least so much. */
#define WORTH 0.98
enum { TRIAL_ITERATIONS = 4 };

static struct coefficients *coefficients_of(const struct fit_entry *entry, int p) {
    return &entry->phone->plain[entry->context * PARAM_COUNT + (size_t)p];
}

static void set_entry(const struct fit_entry *entry, int p, const struct coefficients *c) {
    entry->phone->plain[entry->context * PARAM_COUNT + (size_t)p] = *c;
    entry->phone->stressed[entry->context * PARAM_COUNT + (size_t)p] = *c;
}

static void apply(const struct task *task, size_t i, const double *x) {
    const struct fit_entry *entry = &task->fit->entries[task->own[i]];
    struct coefficients c = *coefficients_of(entry, task->param);
    unknowns_to(task->options->function, x, &c);
    set_entry(entry, task->param, &c);
}

static bool takes_part(const struct task *task, const struct track *t) {
    return t->part == task->part && t->recording->curves[task->param];
}

/* F - Y at every frame. */
static void compare(const struct task *task, const struct track *t, double *out) {
    struct curve curve;
    struct curve_cursor cursor = {0};
    targets_curve(task->pack, &t->gestures, task->options->function, task->param, &curve);
    for (size_t n = 0; n < t->recording->frame_count; n++)
        out[n] = curve_at(&curve, t->recording->times[n], &cursor) - t->recording->curves[task->param][n];
    curve_free(&curve);
}

static void residual(void *ctx, const double *x, double *out) {
    const struct task *task = ctx;
    for (size_t i = 0; i < task->own_count; i++)
        apply(task, i, x + i * task->per_entry);
    for (const struct track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t))
            continue;
        compare(task, t, out);
        out += t->recording->frame_count;
    }
    for (size_t i = 0; i < task->own_count * task->per_entry; i++)
        out[i] = PULL * (x[i] - task->start[i]);
}

static void slopes(const struct task *task, size_t entry, const double *at_x, double *moved, double *out,
                   size_t stride) {
    for (const struct track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t))
            continue;
        size_t frames = t->recording->frame_count;
        if (t->uses[entry]) {
            compare(task, t, moved);
            for (size_t n = 0; n < frames; n++)
                out[n * stride] = (moved[n] - at_x[n]) / STEP;
        }
        at_x += frames;
        out += frames * stride;
    }
}

static void jacobian(void *ctx, const double *x, double *out, size_t stride) {
    const struct task *task = ctx;
    size_t unknowns = task->own_count * task->per_entry;
    double *at_x = mem_alloc((task->frames + unknowns) * sizeof *at_x);
    double *moved = mem_alloc((task->frames + 1) * sizeof *moved);
    residual(ctx, x, at_x);
    for (size_t i = 0; i < task->own_count; i++) {
        double y[UNKNOWNS_MOST];
        const double *own = x + i * task->per_entry;
        for (size_t k = 0; k < task->per_entry; k++) {
            size_t column = i * task->per_entry + k;
            memcpy(y, own, task->per_entry * sizeof *y);
            y[k] += STEP;
            apply(task, i, y);
            slopes(task, task->own[i], at_x, moved, out + column, stride);
            out[(task->frames + column) * stride + column] = PULL;
        }
        apply(task, i, own);
    }
    free(moved);
    free(at_x);
}

static void progress(void *ctx, int iteration, double sum) {
    const struct task *task = ctx;
    if (!task->options->progress)
        return;
    struct fit_step step = {task->param, task->part, task->parts, task->iterations_before + iteration,
                            sqrt(sum / (double)task->frames)};
    task->options->progress(task->options->ctx, &step);
}

/* The data where the pack expects the target. */
static double mean_at_target(const struct task *task, size_t entry, double place) {
    double sum = 0;
    size_t n = 0;
    const struct speech_phone *phone = task->fit->entries[entry].phone;
    for (const struct track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t) || !t->uses[entry])
            continue;
        for (size_t g = 0; g < t->gestures.count; g++) {
            const struct phone_segment *item = &t->gestures.items[g];
            if (item->phone != phone)
                continue;
            size_t frame = (size_t)((item->start + place * (item->end - item->start)) * RECORDING_FPS);
            if (frame < t->recording->frame_count) {
                sum += t->recording->curves[task->param][frame];
                n++;
            }
        }
    }
    return n ? sum / (double)n : 0;
}

static void begin(struct task *task) {
    for (size_t i = 0; i < task->own_count; i++) {
        const struct fit_entry *entry = &task->fit->entries[task->own[i]];
        const struct coefficients *inherited = coefficients_of(entry, task->param);
        struct coefficients c = unknowns_start(inherited->k >= 0.5, entry->phone->group->vowel);
        c.t = inherited->t;
        c.T = mean_at_target(task, task->own[i], c.t);
        set_entry(entry, task->param, &c);
        unknowns_of(task->options->function, &c, task->start + i * task->per_entry);
    }
}

static void swap_resistance(const struct task *task, const struct speech_phone *phone) {
    for (size_t i = 0; i < task->own_count; i++) {
        const struct fit_entry *entry = &task->fit->entries[task->own[i]];
        if (entry->phone != phone)
            continue;
        struct coefficients c = *coefficients_of(entry, task->param);
        c.k = c.k >= DOMINANCE_RESISTANT ? 0 : 1;
        set_entry(entry, task->param, &c);
    }
}

static void try_resistances(struct task *task, struct least_squares *problem, double *x, double sum) {
    size_t bytes = problem->unknowns * sizeof *x;
    double *trial = mem_alloc(bytes);
    for (size_t i = 0; i < task->own_count; i++) {
        const struct speech_phone *phone = task->fit->entries[task->own[i]].phone;
        bool seen = false;
        for (size_t k = 0; k < i; k++)
            seen |= task->fit->entries[task->own[k]].phone == phone;
        if (seen)
            continue;
        memcpy(trial, x, bytes);
        swap_resistance(task, phone);
        double swapped = least_squares_run(problem, trial, TRIAL_ITERATIONS);
        if (swapped < WORTH * sum) {
            memcpy(x, trial, bytes);
            sum = swapped;
        } else {
            swap_resistance(task, phone);
        }
    }
    free(trial);
}

static void look(struct task *task, struct least_squares *problem, double *x, double sum) {
    bool anew = false;
    for (size_t i = 0; i < problem->unknowns; i++) {
        if (unknowns_at_limit(x[i], i % task->per_entry)) {
            x[i] = task->start[i];
            anew = true;
        }
    }
    if (task->options->function != TARGETS_LOOK_AHEAD)
        return;
    if (anew)
        sum = least_squares_run(problem, x, TRIAL_ITERATIONS);
    try_resistances(task, problem, x, sum);
}

static void run_task(struct task *task) {
    size_t unknowns = task->own_count * task->per_entry;
    struct least_squares problem = {task->frames + unknowns, unknowns, task, residual, jacobian, progress};
    task->start = mem_alloc(unknowns * sizeof *task->start);
    double *x = mem_alloc(unknowns * sizeof *x);
    begin(task);
    memcpy(x, task->start, unknowns * sizeof *x);
    double sum = least_squares_run(&problem, x, task->options->first);
    if (task->options->then > 0) {
        problem.progress = NULL;
        look(task, &problem, x, sum);
        problem.progress = progress;
        task->iterations_before = task->options->first;
        least_squares_run(&problem, x, task->options->then);
    }
    for (size_t i = 0; i < task->own_count; i++)
        apply(task, i, x + i * task->per_entry);
    free(x);
    free(task->start);
}

void task_fit(struct task *task) {
    task->own_count = task->frames = 0;
    for (const struct track *t = task->tracks; t < task->tracks + task->track_count; t++)
        if (takes_part(task, t))
            task->frames += t->recording->frame_count;
    for (size_t e = 0; e < task->fit->entry_count; e++) {
        bool used = false;
        for (const struct track *t = task->tracks; t < task->tracks + task->track_count; t++)
            used |= takes_part(task, t) && t->uses[e];
        if (used)
            task->own[task->own_count++] = e;
    }
    if (task->own_count)
        run_task(task);
}

void task_measure(struct task *task) {
    struct fit *fit = task->fit;
    double sum = 0, worst = 0;
    size_t frames = 0;
    for (const struct track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        task->part = t->part;
        if (!takes_part(task, t))
            continue;
        double *difference = mem_alloc((t->recording->frame_count + 1) * sizeof *difference);
        compare(task, t, difference);
        for (size_t n = 0; n < t->recording->frame_count; n++) {
            sum += fabs(difference[n]);
            worst = fmax(worst, fabs(difference[n]));
        }
        frames += t->recording->frame_count;
        free(difference);
    }
    fit->fitted[task->param] = frames > 0;
    fit->error[task->param] = frames ? sum / (double)frames : 0;
    fit->worst[task->param] = worst;
}
