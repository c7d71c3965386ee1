/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/research/fit_internal.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Nonlinear least squares by a trust-region method with a two-dimensional subspace (Byrd, Schnabel and
 * Shultz, Mathematical Programming 40, 1988), from the GNU Scientific Library. */

struct least_squares {
    size_t residuals, unknowns; /* at least as many residuals as unknowns */
    void *ctx;
    void (*residual)(void *ctx, const double *x, double *out);
    /* d residual i / d unknown j into out[i * stride + j]; out comes as zeros */
    void (*jacobian)(void *ctx, const double *x, double *out, size_t stride);
    void (*progress)(void *ctx, int iteration, double sum); /* may be NULL */
};

static int residual(const gsl_vector *x, void *ctx, gsl_vector *f) {
    const struct least_squares *p = ctx;
    p->residual(p->ctx, x->data, f->data);
    return GSL_SUCCESS;
}

static int jacobian(const gsl_vector *x, void *ctx, gsl_matrix *j) {
    const struct least_squares *p = ctx;
    gsl_matrix_set_zero(j);
    p->jacobian(p->ctx, x->data, j->data, j->tda);
    return GSL_SUCCESS;
}

static double sum_of_squares(const gsl_multifit_nlinear_workspace *w) {
    double norm = gsl_blas_dnrm2(gsl_multifit_nlinear_residual(w));
    return norm * norm;
}

/* Improves x in at most that many iterations; stops when no step reduces the sum of squares. Returns the
 * sum. */
static double least_squares_run(const struct least_squares *problem, double *x, int iterations) {
    /* a failed step must not abort the program */
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
    how.trs = gsl_multifit_nlinear_trs_subspace2D;
    /* The regularisation keeps the normal equations regular. */
    how.solver = gsl_multifit_nlinear_solver_cholesky;
    gsl_multifit_nlinear_workspace *w =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, problem->residuals, problem->unknowns);
    gsl_multifit_nlinear_fdf fdf = {.f = residual,
                                    .df = jacobian,
                                    .n = problem->residuals,
                                    .p = problem->unknowns,
                                    .params = (void *)problem};
    gsl_vector_const_view start = gsl_vector_const_view_array(x, problem->unknowns);
    gsl_multifit_nlinear_init(&start.vector, &fdf, w);
    for (int i = 1; i <= iterations; i++) {
        if (gsl_multifit_nlinear_iterate(w) != GSL_SUCCESS)
            break;
        if (problem->progress)
            problem->progress(problem->ctx, i, sum_of_squares(w));
    }
    double sum = sum_of_squares(w);
    memcpy(x, gsl_multifit_nlinear_position(w)->data, problem->unknowns * sizeof *x);
    gsl_multifit_nlinear_free(w);
    gsl_set_error_handler(handler);
    return sum;
}

enum scale { SCALE_TARGET, SCALE_EVEN, SCALE_LOGARITHMIC };

#define FIELD(name) offsetof(struct coefficients, name)

/* Spread: of targets in mm, a few as between people; of the others in x, half to double of an extent, a
 * third of the phone for the position of the target. */
static const struct unknown {
    size_t field, twin; /* twin gets the same value */
    enum scale scale;
    double min, max, spread;
} look_ahead[UNKNOWNS_LOOK_AHEAD] =
    {
        {FIELD(t), FIELD(t), SCALE_EVEN, 0.02, 0.98, 0.7},
        {FIELD(T), FIELD(T), SCALE_TARGET, 0, 0, 1.5},
        {FIELD(alpha), FIELD(alpha), SCALE_EVEN, 0.005, 1, 1},
        {FIELD(theta_bw), FIELD(theta_bw), SCALE_LOGARITHMIC, 1, 100, 0.7},
        {FIELD(theta_fw), FIELD(theta_fw), SCALE_LOGARITHMIC, 1, 100, 0.7},
        {FIELD(c_bw), FIELD(c_bw), SCALE_LOGARITHMIC, 0.3, 3, 0.6},
        {FIELD(c_fw), FIELD(c_fw), SCALE_LOGARITHMIC, 0.3, 3, 0.6},
        {FIELD(p_bw), FIELD(p_bw), SCALE_LOGARITHMIC, 0.3, 3, 0.4},
        {FIELD(p_fw), FIELD(p_fw), SCALE_LOGARITHMIC, 0.3, 3, 0.4},
        {FIELD(beta_bw), FIELD(beta_bw), SCALE_EVEN, -2, 2, 0.3},
        {FIELD(beta_fw), FIELD(beta_fw), SCALE_EVEN, -2, 2, 0.3},
},
  original[UNKNOWNS_ORIGINAL] = {
      {FIELD(t), FIELD(t), SCALE_EVEN, 0.02, 0.98, 0.7},
      {FIELD(T), FIELD(T), SCALE_TARGET, 0, 0, 1.5},
      {FIELD(alpha), FIELD(alpha), SCALE_EVEN, 0.005, 1, 1},
      {FIELD(theta_bw), FIELD(theta_bw), SCALE_LOGARITHMIC, 1, 100, 0.7},
      {FIELD(theta_fw), FIELD(theta_fw), SCALE_LOGARITHMIC, 1, 100, 0.7},
      {FIELD(c_bw), FIELD(c_fw), SCALE_LOGARITHMIC, 0.3, 3, 0.6},
};

/* Range of a mouth relative to rest, mm: soft lips can be pressed by 3, no jaw drops by more than 30
 * (adults open about 50 between the incisors, far more than in speech). */
static const struct {
    double min, max;
} anatomy[PARAM_COUNT] = {
    [PARAM_LI] = {-3, 22},  [PARAM_LS] = {-3, 10},  [PARAM_AR] = {-18, 12},
    [PARAM_PI] = {-7, 9},   [PARAM_PS] = {-5, 9},   [PARAM_EM] = {-1, 30},
    [PARAM_TH] = {-18, 14}, [PARAM_TA] = {-12, 14}, [PARAM_TB] = {-16, 16},
};

static const struct unknown *unknowns(enum targets_function function) {
    return function == TARGETS_ORIGINAL ? original : look_ahead;
}

static size_t unknowns_count(enum targets_function function) {
    return function == TARGETS_ORIGINAL ? UNKNOWNS_ORIGINAL : UNKNOWNS_LOOK_AHEAD;
}

/* Expected distance of the unknown from the pack's value: the unit of a change. */
static double unknowns_spread(enum targets_function function, size_t unknown) {
    return unknowns(function)[unknown].spread;
}

/* A start keeps at least this share of the range away from a limit, where it could not change. */
#define MARGIN 0.01

static double to_unknown(const struct unknown *u, double value) {
    double part = u->scale == SCALE_EVEN ? (value - u->min) / (u->max - u->min)
                                         : log(fmax(value, u->min) / u->min) / log(u->max / u->min);
    part = fmin(fmax(part, MARGIN), 1 - MARGIN);
    return log(part / (1 - part));
}

static double to_value(const struct unknown *u, double x) {
    double part = 1 / (1 + exp(-x));
    return u->scale == SCALE_EVEN ? u->min + part * (u->max - u->min) : u->min * pow(u->max / u->min, part);
}

/* The target in mm, limited by anatomy. */
static double unknowns_limited(int p, double T) {
    return fmin(fmax(T, anatomy[p].min), anatomy[p].max);
}

/* Applies x to a start within the limits, relative to the value itself, which may be at or beyond a limit. */
static double moved(const struct unknown *u, double own, double x) {
    double start = to_unknown(u, own), from = to_value(u, start), to = to_value(u, start + x);
    double value = u->scale == SCALE_EVEN ? own + to - from : own * to / from;
    return fmin(fmax(value, fmin(own, u->min)), fmax(own, u->max));
}

/* Coefficients of parameter p at distance x from the base. x = 0 gives the base itself, as does a base
 * without dominance. */
static struct coefficients unknowns_moved(enum targets_function function, const struct coefficients *base,
                                          int p, const double *x) {
    struct coefficients c = *base;
    for (size_t i = 0; i < unknowns_count(function) && base->alpha > 0; i++) {
        const struct unknown *u = &unknowns(function)[i];
        double own = *(const double *)((const char *)base + u->field);
        if (x[i] == 0)
            continue;
        double value = u->scale == SCALE_TARGET ? unknowns_limited(p, own + x[i]) : moved(u, own, x[i]);
        *(double *)((char *)&c + u->field) = value;
        *(double *)((char *)&c + u->twin) = value;
    }
    return c;
}

/* The phones spoken, each once. */
struct sounds {
    const struct speech_phone **items;
    size_t count, cap;
};

static void add(struct sounds *sounds, const struct speech_phone *phone) {
    for (size_t i = 0; i < sounds->count; i++)
        if (sounds->items[i] == phone)
            return;
    sounds->items = mem_grow(sounds->items, &sounds->cap, sounds->count + 1, sizeof *sounds->items);
    sounds->items[sounds->count++] = phone;
}

static int compare(const void *a, const void *b) {
    const struct speech_phone *x = *(const struct speech_phone *const *)a,
                              *y = *(const struct speech_phone *const *)b;
    int order = strcmp(x->group->name, y->group->name);
    return order ? order : strcmp(x->ipa, y->ipa);
}

/* Phones of a group get consecutive numbers and so different folds: the rest of the group predicts the one
 * held out. */
static size_t place(const struct sounds *sounds, const struct speech_phone *phone) {
    for (size_t i = 0; i < sounds->count; i++)
        if (sounds->items[i] == phone)
            return i;
    return sounds->count; /* a pause */
}

static uint8_t *folds_of(const struct fit_track *t, size_t number, bool whole, bool rest_known,
                         const struct sounds *sounds) {
    const struct measured_speech *r = t->recording;
    const struct phone_segments *g = &t->segments;
    uint8_t *folds = mem_alloc(r->frame_count + 1);
    size_t at = 0;
    for (size_t n = 0; n < r->frame_count; n++) {
        while (at < g->count && r->times[n] >= g->items[at].end)
            at++;
        const struct speech_phone *phone =
            at < g->count && r->times[n] >= g->items[at].start ? g->items[at].phone : NULL;
        size_t part = whole ? number : place(sounds, phone);
        folds[n] = phone || rest_known ? (uint8_t)(part % TASK_FOLDS) : FOLD_NONE;
    }
    return folds;
}

void folds_make(struct fit_track *tracks, size_t count, bool rest_known) {
    struct sounds sounds = {0};
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < tracks[i].segments.count; k++)
            if (tracks[i].segments.items[k].phone)
                add(&sounds, tracks[i].segments.items[k].phone);
    if (sounds.count)
        qsort(sounds.items, sounds.count, sizeof *sounds.items, compare);
    for (size_t i = 0; i < count; i++)
        tracks[i].folds = folds_of(&tracks[i], i, count >= TASK_FOLDS, rest_known, &sounds);
    free(sounds.items);
}

/* True when a frame has data for the task's parameter. */
static bool folds_tell(const struct task *task, const struct fit_track *t, size_t frame) {
    const bool *unseen = t->recording->unseen[task->param];
    return t->folds[frame] != FOLD_NONE && !(unseen && unseen[frame]);
}

/* Step for numerical derivatives, in unknowns. */
#define STEP 1e-4

/* The scale of a speaker's movements is half to double of another's. Its logarithm is expected within
 * this, and weighed against 1 mm regardless of the strength, as it needs no caution. */
#define SCALE_SPREAD 0.4

enum { SCALE = 0, KINDS = 2 };

/* Block of an unknown: the kinds, the groups, then the entries. Not for SCALE. */
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

/* Shrinks all changes except the scale to that part. */
static void moves_shrink(const struct task *task, double *x, double part) {
    for (size_t i = 0; i < moves_count(task); i++)
        if (i != SCALE)
            x[i] *= part;
}

/* Regularisation of an unknown per unit. */
static double moves_pull(const struct task *task, size_t unknown) {
    if (unknown == SCALE)
        return 1 / SCALE_SPREAD;
    return task->strength / unknowns_spread(task->options->function, place_of(task, unknown).unknown);
}

static const double *block(const struct task *task, const double *x, size_t number) {
    return x + 1 + number * task->per_block;
}

/* A contact stays where it is instead of moving with its kind: the contact layer would hold it there and
 * displace the other lip. Only recordings of the phone itself can move it. */
static bool is_touching(const struct speech_phone *phone, int p) {
    return (phone->contact.kind == CONTACT_LIPS && (p == PARAM_LI || p == PARAM_LS)) ||
           (phone->contact.kind == CONTACT_TEETH && (p == PARAM_LI || p == PARAM_PI));
}

/* group and own: NULL = none */
static struct coefficients moved_coefficients(const struct task *task, const struct speech_phone *phone,
                                              const struct coefficients *base, const double *x,
                                              const double *group, const double *own) {
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
    phone->plain[at] = moved_coefficients(task, phone, &s->plain, x, group, own);
    phone->stressed[at] = moved_coefficients(task, phone, &s->stressed, x, group, own);
}

/* Applies x to the pack: to all entries, or to those that an unknown affects. */
static void moves_apply(const struct task *task, const double *x) {
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

static void moves_apply_to(const struct task *task, const double *x, size_t unknown) {
    for (size_t i = 0; i < task->fit->entry_count; i++)
        if (moves_entry(task, unknown, i))
            set_slot(task, i, x);
}

/* True when the track has an entry that the unknown affects. */
static bool moves_is_felt(const struct task *task, const struct fit_track *t, size_t unknown) {
    for (size_t i = 0; i < task->fit->entry_count; i++)
        if (t->uses[i] && moves_entry(task, unknown, i))
            return true;
    return false;
}

/* Moves the other phones with their kind, group and the scale, so that they match the fitted ones. Call it
 * once, as it starts from the pack's values. */
static void moves_apply_to_others(const struct task *task, const double *x) {
    for (size_t i = 0; i < task->fit->other_count; i++) {
        const struct fit_entry *e = &task->fit->others[i];
        size_t at = e->context * PARAM_COUNT + (size_t)task->param;
        const double *group = NULL;
        for (size_t g = 0; g < task->group_count; g++)
            if (task->groups[g] == e->phone->group)
                group = block(task, x, KINDS + g);
        e->phone->plain[at] = moved_coefficients(task, e->phone, &e->phone->plain[at], x, group, NULL);
        e->phone->stressed[at] = moved_coefficients(task, e->phone, &e->phone->stressed[at], x, group, NULL);
    }
}

/* Root of the sum of squares of the curves about their means, over the frames that count, for the pack's
 * current values. */
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

/* Scale that preserves the amplitude of x = 0, so that x changes the shape only. 1 where nothing moves. */
static double moves_same_amplitude(const struct task *task, const double *x) {
    size_t count = moves_count(task);
    double *y = mem_alloc(count * sizeof *y); /* zeros: the original pack */
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

static bool takes_part(const struct task *task, const struct fit_track *t) {
    return t->recording->curves[task->param] != NULL;
}

/* Frames this close to a held-out part do not count, either: disturbances last from one sound to the next
 * and would be predicted with it (Burman, Chow and Nolan, Biometrika 81, 1994). */
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

/* F - Y at frames that count or are held out, 0 elsewhere. If rest is unknown the level is free: it comes
 * from the frames that count, or from all if none does. */
static void compare_track(const struct task *task, const struct fit_track *t, double *out) {
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
    compare_track(task, t, out);
    for (size_t i = 0; i < t->recording->frame_count; i++)
        if (!counts(task, t, i))
            out[i] = 0;
}

/* Copies the solver's unknowns: those that may change. */
static void spread_out(const struct task *task, const double *x) {
    for (size_t i = 0; i < task->moving_count; i++)
        task->all[task->moving[i]] = x[i];
}

static void task_residual(void *ctx, const double *x, double *out) {
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

static void task_jacobian(void *ctx, const double *x, double *out, size_t stride) {
    const struct task *task = ctx;
    double *at_x = mem_alloc((task->frames + task->moving_count) * sizeof *at_x);
    double *at_y = mem_alloc((task->frames + 1) * sizeof *at_y);
    task_residual(ctx, x, at_x);
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
        task->frames + task->moving_count, task->moving_count, task, task_residual, task_jacobian, progress};
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
        compare_track(task, t, difference);
        for (size_t n = 0; n < t->recording->frame_count; n++)
            if (folds_tell(task, t, n) && (fold < 0 || t->folds[n] == fold)) {
                sum += difference[n] * difference[n];
                ++*frames;
            }
        free(difference);
    }
    return sum;
}

/* Scale and level with which F comes nearest to a recording. */
struct nearest {
    double frames, scale, level, sum; /* number, -, mm, sum of the squares that are left */
};

static struct nearest find_nearest(const struct task *task, const struct fit_track *t, const double *curve) {
    double n = 0, f = 0, y = 0, ff = 0, fy = 0, yy = 0;
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
    if (n < 1)
        return (struct nearest){0};
    double vary = ff - f * f / n, both = fmax(0, fy - f * y / n), all = yy - y * y / n;
    double scale = vary > 0 ? both / vary : 0;
    return (struct nearest){n, scale, (y - scale * f) / n, fmax(0, all - scale * both)};
}

double task_shape_error(const struct task *task, size_t *frames) {
    double sum = 0;
    *frames = 0;
    for (const struct fit_track *t = task->tracks; t < task->tracks + task->track_count; t++) {
        if (!takes_part(task, t))
            continue;
        double *curve = mem_alloc((t->recording->frame_count + 1) * sizeof *curve);
        predict(task, t, curve);
        struct nearest nearest = find_nearest(task, t, curve);
        free(curve);
        sum += nearest.sum;
        *frames += (size_t)nearest.frames;
    }
    return sum;
}

void task_shape(const struct task *task, const struct fit_track *t, double *out) {
    predict(task, t, out);
    struct nearest nearest = find_nearest(task, t, out);
    for (size_t i = 0; i < t->recording->frame_count; i++)
        out[i] = folds_tell(task, t, i) ? nearest.scale * out[i] + nearest.level : NAN;
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

/* Records the pack's values. False: there is nothing to fit. */
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
