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

size_t task_unknowns(const struct task *task) {
    return (1 + task->group_count) * task->per_block + task->fit->entry_count * UNKNOWNS_TARGET;
}

/* Which block a column belongs to, and which unknown of it it is. */
static size_t block_of(const struct task *task, size_t column, size_t *unknown) {
    size_t shared = (1 + task->group_count) * task->per_block;
    bool is_shared = column < shared;
    size_t at = is_shared ? column : column - shared, size = is_shared ? task->per_block : UNKNOWNS_TARGET;
    *unknown = at % size;
    return at / size + (is_shared ? 0 : 1 + task->group_count);
}

/* What pulls an unknown back to 0, for each unit of it. */
static double pull(const struct task *task, size_t column) {
    size_t unknown;
    bool is_speaker = block_of(task, column, &unknown) == 0;
    return task->strength / (is_speaker && unknown == UNKNOWNS_T
                                 ? UNKNOWNS_GAIN_SPREAD
                                 : unknowns_spread(task->options->function, unknown));
}

/* What the speaker's block, a group's (NULL = none) and an entry's (NULL = none) make of coefficients. */
static struct coefficients moved(const struct task *task, const struct coefficients *base,
                                 const double *speaker, const double *group, const double *own) {
    struct coefficients c = *base;
    double moves[UNKNOWNS_MOST];
    for (size_t i = 0; i < task->per_block; i++)
        moves[i] = (i == UNKNOWNS_T ? 0 : speaker[i]) + (group ? group[i] : 0) +
                   (own && i < UNKNOWNS_TARGET ? own[i] : 0);
    c.T *= exp(speaker[UNKNOWNS_T]);
    return unknowns_moved(task->options->function, &c, task->param, moves);
}

static void set_slot(const struct task *task, size_t slot, const double *x) {
    const struct task_slot *s = &task->slots[slot];
    const double *group = x + (1 + s->group) * task->per_block,
                 *own = x + (1 + task->group_count) * task->per_block + slot * UNKNOWNS_TARGET;
    size_t at = s->entry->context * PARAM_COUNT + (size_t)task->param;
    s->entry->phone->plain[at] = moved(task, &s->plain, x, group, own);
    s->entry->phone->stressed[at] = moved(task, &s->stressed, x, group, own);
}

void task_apply(const struct task *task, const double *x) {
    for (size_t i = 0; i < task->fit->entry_count; i++)
        set_slot(task, i, x);
}

static bool takes_part(const struct task *task, const struct fit_track *t) {
    return t->recording->curves[task->param] != NULL;
}

static bool counts(const struct task *task, const struct fit_track *t, size_t frame) {
    return t->folds[frame] != FOLD_NONE && t->folds[frame] != task->held;
}

/* F - Y at every frame that counts, 0 at the others. Where the markers' place at rest is not known, their
 * level is free: it is taken from the frames that count, or from all when none does. */
static double compare(const struct task *task, const struct fit_track *t, double *out) {
    struct curve curve;
    struct curve_cursor cursor = {0};
    double level = 0, whole = 0;
    size_t n = 0, frames = t->recording->frame_count, all = 0;
    targets_curve(task->pack, &t->segments, task->options->function, task->param, &curve);
    for (size_t i = 0; i < frames; i++) {
        out[i] = curve_at(&curve, t->recording->times[i], &cursor) - t->recording->curves[task->param][i];
        if (t->folds[i] == FOLD_NONE)
            continue;
        whole += out[i];
        all++;
        if (counts(task, t, i)) {
            level += out[i];
            n++;
        }
    }
    curve_free(&curve);
    level = task->options->rest_known ? 0 : n ? level / (double)n : all ? whole / (double)all : 0;
    for (size_t i = 0; i < frames; i++)
        out[i] = t->folds[i] == FOLD_NONE ? 0 : out[i] - level;
    return level;
}

static void drop_held(const struct task *task, const struct fit_track *t, double *out) {
    for (size_t i = 0; i < t->recording->frame_count; i++)
        if (!counts(task, t, i))
            out[i] = 0;
}

static void residual(void *ctx, const double *x, double *out) {
    const struct task *task = ctx;
    task_apply(task, x);
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t))
            continue;
        compare(task, t, out);
        drop_held(task, t, out);
        out += t->recording->frame_count;
    }
    for (size_t i = 0; i < task_unknowns(task); i++)
        out[i] = pull(task, i) * x[i];
}

static bool is_in(const struct task *task, size_t entry, size_t block) {
    return !block || (block <= task->group_count ? task->slots[entry].group == block - 1
                                                 : entry == block - 1 - task->group_count);
}

/* Does the track use an entry of that block? */
static bool is_felt(const struct task *task, const struct fit_track *t, size_t block) {
    for (size_t i = 0; i < task->fit->entry_count; i++)
        if (t->uses[i] && is_in(task, i, block))
            return true;
    return false;
}

static void move_block(const struct task *task, size_t block, const double *x) {
    for (size_t i = 0; i < task->fit->entry_count; i++)
        if (is_in(task, i, block))
            set_slot(task, i, x);
}

static void slopes(const struct task *task, size_t block, const double *at_x, double *at_y, double *out,
                   size_t stride) {
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t))
            continue;
        size_t frames = t->recording->frame_count;
        if (is_felt(task, t, block)) {
            compare(task, t, at_y);
            drop_held(task, t, at_y);
            for (size_t n = 0; n < frames; n++)
                out[n * stride] = (at_y[n] - at_x[n]) / STEP;
        }
        at_x += frames;
        out += frames * stride;
    }
}

static void jacobian(void *ctx, const double *x, double *out, size_t stride) {
    const struct task *task = ctx;
    size_t unknowns = task_unknowns(task);
    double *at_x = mem_alloc((task->frames + unknowns) * sizeof *at_x);
    double *at_y = mem_alloc((task->frames + 1) * sizeof *at_y);
    double *y = mem_alloc(unknowns * sizeof *y);
    residual(ctx, x, at_x);
    memcpy(y, x, unknowns * sizeof *y);
    for (size_t column = 0; column < unknowns; column++) {
        size_t unknown, block = block_of(task, column, &unknown);
        y[column] += STEP;
        move_block(task, block, y);
        slopes(task, block, at_x, at_y, out + column, stride);
        y[column] = x[column];
        move_block(task, block, y);
        out[(task->frames + column) * stride + column] = pull(task, column);
    }
    free(y);
    free(at_y);
    free(at_x);
}

static void progress(void *ctx, int iteration, double sum) {
    const struct task *task = ctx;
    struct fit_step step = {task->param, task->held, task->strength, iteration,
                            sqrt(sum / (double)(task->frames ? task->frames : 1))};
    if (task->options->progress)
        task->options->progress(task->options->ctx, &step);
}

void task_improve(struct task *task, double *x, int iterations) {
    struct least_squares problem = {
        task->frames + task_unknowns(task), task_unknowns(task), task, residual, jacobian, progress};
    least_squares_run(&problem, x, iterations);
    task_apply(task, x);
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
            if (t->folds[n] != FOLD_NONE && (fold < 0 || t->folds[n] == fold)) {
                sum += difference[n] * difference[n];
                ++*frames;
            }
        free(difference);
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
}

void task_close(struct task *task) {
    free(task->slots);
    free(task->groups);
}

/* The other phones move with their groups and the speaker, so that what the recordings do not contain fits
 * what they do. */
static void move_others(const struct task *task, const double *x) {
    for (size_t i = 0; i < task->fit->other_count; i++) {
        const struct fit_entry *e = &task->fit->others[i];
        size_t at = e->context * PARAM_COUNT + (size_t)task->param;
        const double *group = NULL;
        for (size_t g = 0; g < task->group_count; g++)
            if (task->groups[g] == e->phone->group)
                group = x + (1 + g) * task->per_block;
        e->phone->plain[at] = moved(task, &e->phone->plain[at], x, group, NULL);
        e->phone->stressed[at] = moved(task, &e->phone->stressed[at], x, group, NULL);
    }
}

void task_fit(struct task *task, void (*choose)(struct task *task)) {
    struct fit *fit = task->fit;
    int p = task->param;
    size_t frames = 0;
    task->frames = 0;
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++)
        if (takes_part(task, t)) {
            task->frames += t->recording->frame_count;
            for (size_t n = 0; n < t->recording->frame_count; n++)
                frames += t->folds[n] != FOLD_NONE;
        }
    fit->fitted[p] = frames > 0 && fit->entry_count > 0;
    if (!fit->fitted[p])
        return;
    for (size_t i = 0; i < fit->entry_count; i++) {
        struct task_slot *s = &task->slots[i];
        size_t at = s->entry->context * PARAM_COUNT + (size_t)p;
        s->plain = s->entry->phone->plain[at];
        s->stressed = s->entry->phone->stressed[at];
    }
    fit->unfitted[p] = sqrt(task_error(task, -1, &frames) / (double)frames);
    choose(task);
    double *x = mem_alloc(task_unknowns(task) * sizeof *x);
    task_apply(task, x);
    if (isfinite(task->strength)) {
        task_improve(task, x, task->options->then);
        move_others(task, x);
    } else { /* nothing that was tried foretells the held-out part better than the pack: it stays */
        for (size_t i = 0; i < fit->entry_count; i++) {
            const struct task_slot *s = &task->slots[i];
            size_t at = s->entry->context * PARAM_COUNT + (size_t)p;
            s->entry->phone->plain[at] = s->plain;
            s->entry->phone->stressed[at] = s->stressed;
        }
    }
    free(x);
    fit->strength[p] = task->strength;
    fit->error[p] = sqrt(task_error(task, -1, &frames) / (double)frames);
}
