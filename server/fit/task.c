/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/task.h"
#include "server/base/mem.h"
#include "server/fit/folds.h"
#include "server/fit/least_squares.h"
#include "server/fit/moves.h"
#include "server/fit/unknowns.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Step of the numerical slopes, in unknowns. */
#define STEP 1e-4

static bool takes_part(const struct task *task, const struct fit_track *t) {
    return t->recording->curves[task->param] != NULL;
}

/* Frames so near to a part that is held out do not count either: what disturbs curves lasts from one sound to
 * the next, and would be foretold with it (Burman, Chow and Nolan, Biometrika 81, 1994). */
#define GUARD 0.05

static bool counts(const struct task *task, const struct fit_track *t, size_t frame) {
    const double *times = t->recording->times;
    if (!folds_tell(task, t, frame) || t->folds[frame] == task->held)
        return false;
    if (task->held < 0)
        return true;
    for (size_t i = frame; i-- > 0 && times[frame] - times[i] < GUARD;)
        if (t->folds[i] == task->held)
            return false;
    for (size_t i = frame; ++i < t->recording->frame_count && times[i] - times[frame] < GUARD;)
        if (t->folds[i] == task->held)
            return false;
    return true;
}

static void predict(const struct task *task, const struct fit_track *t, double *out) {
    struct curve curve;
    struct curve_cursor cursor = {0};
    targets_curve(task->pack, &t->segments, task->options->function, task->param, &curve);
    for (size_t i = 0; i < t->recording->frame_count; i++)
        out[i] = curve_at(&curve, t->recording->times[i], &cursor);
    curve_free(&curve);
}

/* F - Y at every frame that counts or is held, 0 at the others. Where the markers' place at rest is not
 * known, their level is free: it is taken from the frames that count, or from all when none does. */
static void compare(const struct task *task, const struct fit_track *t, double *out) {
    double level = 0, whole = 0;
    size_t n = 0, all = 0;
    predict(task, t, out);
    for (size_t i = 0; i < t->recording->frame_count; i++) {
        out[i] -= t->recording->curves[task->param][i];
        if (!folds_tell(task, t, i))
            continue;
        whole += out[i];
        all++;
        if (counts(task, t, i)) {
            level += out[i];
            n++;
        }
    }
    level = task->options->rest_known ? 0 : n ? level / (double)n : all ? whole / (double)all : 0;
    for (size_t i = 0; i < t->recording->frame_count; i++)
        out[i] = folds_tell(task, t, i) ? out[i] - level : 0;
}

static void compare_counted(const struct task *task, const struct fit_track *t, double *out) {
    compare(task, t, out);
    for (size_t i = 0; i < t->recording->frame_count; i++)
        if (!counts(task, t, i))
            out[i] = 0;
}

/* The solver's unknowns are those that move. */
static void spread_out(const struct task *task, const double *x) {
    for (size_t i = 0; i < task->moving_count; i++)
        task->all[task->moving[i]] = x[i];
}

static void residual(void *ctx, const double *x, double *out) {
    const struct task *task = ctx;
    spread_out(task, x);
    moves_apply(task, task->all);
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t))
            continue;
        compare_counted(task, t, out);
        out += t->recording->frame_count;
    }
    for (size_t i = 0; i < task->moving_count; i++)
        out[i] = moves_pull(task, task->moving[i]) * x[i];
}

static void slopes(const struct task *task, size_t unknown, const double *at_x, double *at_y, double *out,
                   size_t stride) {
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t))
            continue;
        size_t frames = t->recording->frame_count;
        if (moves_is_felt(task, t, unknown)) {
            compare_counted(task, t, at_y);
            for (size_t n = 0; n < frames; n++)
                out[n * stride] = (at_y[n] - at_x[n]) / STEP;
        }
        at_x += frames;
        out += frames * stride;
    }
}

static void jacobian(void *ctx, const double *x, double *out, size_t stride) {
    const struct task *task = ctx;
    double *at_x = mem_alloc((task->frames + task->moving_count) * sizeof *at_x);
    double *at_y = mem_alloc((task->frames + 1) * sizeof *at_y);
    residual(ctx, x, at_x);
    for (size_t i = 0; i < task->moving_count; i++) {
        size_t unknown = task->moving[i];
        task->all[unknown] += STEP;
        moves_apply_to(task, task->all, unknown);
        slopes(task, unknown, at_x, at_y, out + i, stride);
        task->all[unknown] = x[i];
        moves_apply_to(task, task->all, unknown);
        out[(task->frames + i) * stride + i] = moves_pull(task, unknown);
    }
    free(at_y);
    free(at_x);
}

static void progress(void *ctx, int iteration, double sum) {
    const struct task *task = ctx;
    struct fit_step step = {task->param, task->held,
                            task->level, task->strength,
                            iteration,   sqrt(sum / (double)(task->frames ? task->frames : 1))};
    if (task->options->progress)
        task->options->progress(task->options->ctx, &step);
}

void task_improve(struct task *task, double *x, int iterations) {
    struct least_squares problem = {
        task->frames + task->moving_count, task->moving_count, task, residual, jacobian, progress};
    double *moving = mem_alloc((task->moving_count + 1) * sizeof *moving);
    memcpy(task->all, x, moves_count(task) * sizeof *x);
    for (size_t i = 0; i < task->moving_count; i++)
        moving[i] = x[task->moving[i]];
    least_squares_run(&problem, moving, iterations);
    spread_out(task, moving);
    memcpy(x, task->all, moves_count(task) * sizeof *x);
    moves_apply(task, x);
    free(moving);
}

void task_finish(struct task *task, double *x) {
    if (task->options->own || task->level == FIT_SCALE)
        return;
    moves_shrink(task, x, FIT_SHARED);
    moves_choose(task, FIT_SCALE);
    task_improve(task, x, task->options->first);
    moves_choose(task, task->level);
}

double task_error(const struct task *task, int fold, size_t *frames) {
    double sum = 0;
    *frames = 0;
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t))
            continue;
        double *difference = mem_alloc((t->recording->frame_count + 1) * sizeof *difference);
        compare(task, t, difference);
        for (size_t n = 0; n < t->recording->frame_count; n++)
            if (folds_tell(task, t, n) && (fold < 0 || t->folds[n] == fold)) {
                sum += difference[n] * difference[n];
                ++*frames;
            }
        free(difference);
    }
    return sum;
}

double task_shape_error(const struct task *task, size_t *frames) {
    double sum = 0;
    *frames = 0;
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        double n = 0, f = 0, y = 0, ff = 0, fy = 0, yy = 0;
        if (!takes_part(task, t))
            continue;
        double *curve = mem_alloc((t->recording->frame_count + 1) * sizeof *curve);
        predict(task, t, curve);
        for (size_t i = 0; i < t->recording->frame_count; i++) {
            double own = t->recording->curves[task->param][i];
            if (!folds_tell(task, t, i))
                continue;
            n++;
            f += curve[i];
            y += own;
            ff += curve[i] * curve[i];
            fy += curve[i] * own;
            yy += own * own;
        }
        free(curve);
        if (n < 1)
            continue;
        double vary = ff - f * f / n, both = fmax(0, fy - f * y / n), all = yy - y * y / n;
        sum += fmax(0, all - (vary > 0 ? both * both / vary : 0));
        *frames += (size_t)n;
    }
    return sum;
}

static size_t find_group(struct task *task, const struct speech_group *group) {
    size_t i = 0;
    while (i < task->group_count && task->groups[i] != group)
        i++;
    if (i == task->group_count)
        task->groups[task->group_count++] = group;
    return i;
}

void task_open(struct task *task) {
    size_t entries = task->fit->entry_count;
    task->slots = mem_alloc((entries + 1) * sizeof *task->slots);
    task->groups = mem_alloc((entries + 1) * sizeof *task->groups);
    task->per_block = unknowns_count(task->options->function);
    task->held = -1;
    for (size_t i = 0; i < entries; i++) {
        struct task_slot *s = &task->slots[i];
        s->entry = &task->fit->entries[i];
        s->group = find_group(task, s->entry->phone->group);
    }
    task->all = mem_alloc(moves_count(task) * sizeof *task->all);
    task->moving = mem_alloc(moves_count(task) * sizeof *task->moving);
}

void task_close(struct task *task) {
    free(task->slots);
    free(task->groups);
    free(task->all);
    free(task->moving);
}

/* Takes down what the pack gives, and says whether there is anything to fit. */
static bool begin(struct task *task) {
    struct fit *fit = task->fit;
    size_t frames = 0;
    task->frames = 0;
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++)
        if (takes_part(task, t)) {
            task->frames += t->recording->frame_count;
            for (size_t n = 0; n < t->recording->frame_count; n++)
                frames += folds_tell(task, t, n);
        }
    for (size_t i = 0; i < fit->entry_count; i++) {
        struct task_slot *s = &task->slots[i];
        size_t at = s->entry->context * PARAM_COUNT + (size_t)task->param;
        s->plain = s->entry->phone->plain[at];
        s->stressed = s->entry->phone->stressed[at];
    }
    return frames > 0 && fit->entry_count > 0;
}

static double root_mean(const struct task *task) {
    size_t frames;
    double sum = task_error(task, -1, &frames);
    return sqrt(sum / (double)(frames ? frames : 1));
}

void task_fit(struct task *task, void (*choose)(struct task *task)) {
    struct fit *fit = task->fit;
    int p = task->param;
    fit->fitted[p] = begin(task);
    if (!fit->fitted[p])
        return;
    double *x = mem_alloc(moves_count(task) * sizeof *x);
    task->level = FIT_SCALE;
    moves_choose(task, task->level);
    task_improve(task, x, task->options->then);
    fit->unfitted[p] = root_mean(task);
    choose(task);
    moves_choose(task, task->level);
    task_improve(task, x, task->options->then);
    task_finish(task, x);
    fit->error[p] = root_mean(task);
    fit->scale[p] = exp(x[0]);
    if (!task->options->own)
        x[0] = log(moves_same_amplitude(task, x));
    fit->level[p] = task->level;
    fit->strength[p] = task->strength;
    fit->kept[p] = task->level == FIT_SCALE && !task->options->own;
    moves_apply(task, x);
    moves_apply_to_others(task, x);
    free(x);
}
