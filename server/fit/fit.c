/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/fit.h"
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

/* A recording in the parameter that is being fitted. */
struct track {
    const struct recording *recording;
    struct gestures gestures;
    bool *uses; /* by entry */
    size_t part;
};

/* What is fitted together. */
struct task {
    const struct speech_pack *pack;
    const struct fit_options *options;
    int param;
    size_t part, parts;
    int iterations_before;
    struct fit *fit;
    struct track *tracks;
    size_t track_count;
    size_t *own; /* entries */
    size_t own_count;
    size_t per_entry, frames;
    double *start; /* unknowns */
};

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
            const struct gesture *item = &t->gestures.items[g];
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

static size_t find_entry(struct fit *fit, const struct speech_phone *phone, size_t context) {
    for (size_t i = 0; i < fit->entry_count; i++)
        if (fit->entries[i].phone == phone && fit->entries[i].context == context)
            return i;
    fit->entries = mem_grow(fit->entries, &fit->entry_cap, fit->entry_count + 1, sizeof *fit->entries);
    fit->entries[fit->entry_count] = (struct fit_entry){phone, context};
    return fit->entry_count++;
}

/* Calls find_entry for all that the gestures contain, and notes it where there is a list. */
static void list_entries(struct fit *fit, const struct gestures *g, bool *uses) {
    struct target_contexts *contexts = targets_contexts(g);
    for (size_t i = 0; i < g->count; i++) {
        if (!g->items[i].phone)
            continue;
        size_t before = find_entry(fit, g->items[i].phone, contexts[i].before),
               after = find_entry(fit, g->items[i].phone, contexts[i].after);
        if (uses)
            uses[before] = uses[after] = true;
    }
    free(contexts);
}

/* Numbers the parts: recordings that have an entry in common, directly or through others, belong to one. */
static size_t find_parts(struct track *tracks, size_t count, size_t entries) {
    size_t parts = 0;
    for (size_t i = 0; i < count; i++) {
        tracks[i].part = parts++;
        for (size_t k = 0; k < i; k++) {
            bool shared = false;
            for (size_t e = 0; e < entries; e++)
                shared |= tracks[i].uses[e] && tracks[k].uses[e];
            size_t from = tracks[k].part, into = tracks[i].part;
            for (size_t m = 0; m <= i && shared; m++)
                if (tracks[m].part == from)
                    tracks[m].part = into;
        }
    }
    /* from 0 without gaps */
    size_t used = 0;
    for (size_t part = 0; part < parts; part++) {
        bool found = false;
        for (size_t i = 0; i < count; i++) {
            if (tracks[i].part == part) {
                tracks[i].part = used;
                found = true;
            }
        }
        used += found;
    }
    return used;
}

static void fit_part(struct task *task) {
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

static void measure(struct task *task) {
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

void fit_run(struct speech_pack *pack, const struct recording *recordings, size_t count,
             const struct fit_options *options, struct fit *out) {
    *out = (struct fit){0};
    struct track *tracks = mem_alloc((count + 1) * sizeof *tracks);
    for (size_t i = 0; i < count; i++) {
        tracks[i].recording = &recordings[i];
        recording_gestures(pack, &recordings[i], options->warn, options->ctx, &tracks[i].gestures);
        list_entries(out, &tracks[i].gestures, NULL);
    }
    for (size_t i = 0; i < count; i++) {
        tracks[i].uses = mem_alloc(out->entry_count + 1);
        list_entries(out, &tracks[i].gestures, tracks[i].uses);
    }
    struct task task = {.pack = pack,
                        .options = options,
                        .parts = find_parts(tracks, count, out->entry_count),
                        .fit = out,
                        .tracks = tracks,
                        .track_count = count,
                        .own = mem_alloc((out->entry_count + 1) * sizeof *task.own),
                        .per_entry = unknowns_count(options->function)};
    for (task.param = 0; task.param < PARAM_COUNT; task.param++) {
        for (task.part = 0; task.part < task.parts; task.part++) {
            task.iterations_before = 0;
            fit_part(&task);
        }
        measure(&task);
    }
    for (size_t i = 0; i < count; i++) {
        gestures_free(&tracks[i].gestures);
        free(tracks[i].uses);
    }
    free(tracks);
    free(task.own);
}

void fit_free(struct fit *fit) {
    free(fit->entries);
    *fit = (struct fit){0};
}
