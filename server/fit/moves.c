/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/moves.h"
#include "server/base/mem.h"
#include "server/fit/folds.h"
#include "server/fit/unknowns.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One speaker moves as far as half to double of another: its logarithm is expected within this, and is
 * weighed against 1 mm whatever the strength, since it is not what a fit has to be careful with. */
#define SCALE_SPREAD 0.4

enum { SCALE = 0, KINDS = 2 };

/* Which block an unknown is in: the kinds, the groups, then the entries. Not for SCALE. */
struct place {
    size_t block, unknown;
};

static size_t shared_count(const struct task *task) {
    return 1 + (KINDS + task->group_count) * task->per_block;
}

static struct place place_of(const struct task *task, size_t unknown) {
    size_t shared = shared_count(task);
    if (unknown < shared)
        return (struct place){(unknown - 1) / task->per_block, (unknown - 1) % task->per_block};
    unknown -= shared;
    return (struct place){KINDS + task->group_count + unknown / UNKNOWNS_TARGET, unknown % UNKNOWNS_TARGET};
}

size_t moves_count(const struct task *task) {
    return shared_count(task) + task->fit->entry_count * UNKNOWNS_TARGET;
}

static bool is_free(const struct task *task, size_t unknown, enum fit_level level) {
    if (unknown == SCALE)
        return true;
    struct place place = place_of(task, unknown);
    if (place.block < KINDS)
        return level >= FIT_KINDS;
    if (place.block < KINDS + task->group_count && place.unknown < UNKNOWNS_TARGET)
        return level >= FIT_GROUPS;
    return level >= FIT_PHONES;
}

void moves_choose(struct task *task, enum fit_level level) {
    task->moving_count = 0;
    for (size_t i = 0; i < moves_count(task); i++)
        if (is_free(task, i, level))
            task->moving[task->moving_count++] = i;
}

void moves_shrink(const struct task *task, double *x, double part) {
    for (size_t i = 0; i < moves_count(task); i++)
        if (i != SCALE)
            x[i] *= part;
}

double moves_pull(const struct task *task, size_t unknown) {
    if (unknown == SCALE)
        return 1 / SCALE_SPREAD;
    return task->strength / unknowns_spread(task->options->function, place_of(task, unknown).unknown);
}

static const double *block(const struct task *task, const double *x, size_t number) {
    return x + 1 + number * task->per_block;
}

/* What touches is where it touches, not where its kind goes: the layer of contacts would hold it there, and
 * take the other lip along. Only recordings of the phone itself can tell more of it. */
static bool is_touching(const struct speech_phone *phone, int p) {
    return (phone->contact.kind == CONTACT_LIPS && (p == PARAM_LI || p == PARAM_LS)) ||
           (phone->contact.kind == CONTACT_TEETH && (p == PARAM_LI || p == PARAM_PI));
}

/* group and own: NULL = none */
static struct coefficients moved(const struct task *task, const struct speech_phone *phone,
                                 const struct coefficients *base, const double *x, const double *group,
                                 const double *own) {
    const double *kind = block(task, x, phone->group->vowel);
    double moves[UNKNOWNS_MOST];
    for (size_t i = 0; i < task->per_block; i++)
        moves[i] = kind[i] + (group ? group[i] : 0) + (own && i < UNKNOWNS_TARGET ? own[i] : 0);
    if (is_touching(phone, task->param))
        moves[UNKNOWNS_T] = own ? own[UNKNOWNS_T] : 0;
    struct coefficients c = unknowns_moved(task->options->function, base, task->param, moves);
    c.T = unknowns_limited(task->param, c.T * exp(x[SCALE]));
    return c;
}

static void set_slot(const struct task *task, size_t slot, const double *x) {
    const struct task_slot *s = &task->slots[slot];
    const struct speech_phone *phone = s->entry->phone;
    const double *group = block(task, x, KINDS + s->group),
                 *own = x + shared_count(task) + slot * UNKNOWNS_TARGET;
    size_t at = s->entry->context * PARAM_COUNT + (size_t)task->param;
    phone->plain[at] = moved(task, phone, &s->plain, x, group, own);
    phone->stressed[at] = moved(task, phone, &s->stressed, x, group, own);
}

void moves_apply(const struct task *task, const double *x) {
    for (size_t i = 0; i < task->fit->entry_count; i++)
        set_slot(task, i, x);
}

static bool moves_entry(const struct task *task, size_t unknown, size_t entry) {
    if (unknown == SCALE)
        return true;
    size_t block = place_of(task, unknown).block;
    if (block < KINDS)
        return block == (size_t)task->slots[entry].entry->phone->group->vowel;
    block -= KINDS;
    return block < task->group_count ? task->slots[entry].group == block : entry == block - task->group_count;
}

void moves_apply_to(const struct task *task, const double *x, size_t unknown) {
    for (size_t i = 0; i < task->fit->entry_count; i++)
        if (moves_entry(task, unknown, i))
            set_slot(task, i, x);
}

bool moves_is_felt(const struct task *task, const struct fit_track *t, size_t unknown) {
    for (size_t i = 0; i < task->fit->entry_count; i++)
        if (t->uses[i] && moves_entry(task, unknown, i))
            return true;
    return false;
}

void moves_apply_to_others(const struct task *task, const double *x) {
    for (size_t i = 0; i < task->fit->other_count; i++) {
        const struct fit_entry *e = &task->fit->others[i];
        size_t at = e->context * PARAM_COUNT + (size_t)task->param;
        const double *group = NULL;
        for (size_t g = 0; g < task->group_count; g++)
            if (task->groups[g] == e->phone->group)
                group = block(task, x, KINDS + g);
        e->phone->plain[at] = moved(task, e->phone, &e->phone->plain[at], x, group, NULL);
        e->phone->stressed[at] = moved(task, e->phone, &e->phone->stressed[at], x, group, NULL);
    }
}

/* Root of the sum of squares of the curves about their means, over the frames that count, for what the pack
 * holds. */
static double amplitude(const struct task *task) {
    double all = 0;
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        struct curve curve;
        struct curve_cursor cursor = {0};
        double sum = 0, squares = 0, n = 0;
        if (!t->recording->curves[task->param])
            continue;
        targets_curve(task->pack, &t->segments, task->options->function, task->param, &curve);
        for (size_t i = 0; i < t->recording->frame_count; i++) {
            double y = curve_at(&curve, t->recording->times[i], &cursor);
            if (!folds_tell(task, t, i))
                continue;
            sum += y;
            squares += y * y;
            n++;
        }
        curve_free(&curve);
        all += n > 0 ? squares - sum * sum / n : 0;
    }
    return sqrt(fmax(0, all));
}

double moves_same_amplitude(const struct task *task, const double *x) {
    size_t count = moves_count(task);
    double *y = mem_alloc(count * sizeof *y); /* zeros: the pack as it was */
    moves_apply(task, y);
    double before = amplitude(task);
    memcpy(y, x, count * sizeof *y);
    y[SCALE] = 0;
    moves_apply(task, y);
    double after = amplitude(task);
    moves_apply(task, x);
    free(y);
    return before > 0 && after > 0 ? before / after : 1;
}
