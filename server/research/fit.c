/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/fit.h"
#include "server/base/mem.h"
#include "server/research/fit_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- cross-validation: how much of a pack may change, and how strongly the fit is held to it, by the
 * rule of one standard error (Breiman, Friedman, Olshen and Stone, "Classification and regression trees",
 * 1984, 3.4.3): from the unchanged pack over few, firmly held changes to many, loosely held ones, the
 * first whose error exceeds the least by at most one standard error, or by so little that no recording
 * shows it ---- */

/* Difference of held-out errors that no recording resolves, mm: a hundredth of an articulograph's accuracy.
 * The rounding of FAPs alone makes differences of 0.001 mm. */
#define LEAST_GAIN 0.005

/* mm of error that a change by one spread is weighed against, from firm to loose. */
static const double strengths[] = {12, 6, 3, 1.2, 0.4, 0.12};
enum {
    STRENGTHS = sizeof strengths / sizeof *strengths,
    TRIALS = 1 + (FIT_LEVELS - 1) * STRENGTHS,
    WORSE = 2
};

struct trial {
    enum fit_level level;
    double strength;
    double errors[TASK_FOLDS]; /* sum of squares of each held-out fold, mm^2 */
    double sum;
};

/* All unknowns for a fold. */
static double *state(const struct task *task, double *x, int fold) {
    return x + (size_t)fold * moves_count(task);
}

/* Judges the result as it would be written. */
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

/* Standard error of the total gain, with folds as clusters. Infinite if there are too few. */
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

/* Only whole recordings can validate each phone's own target and the shapes, as they contain the phone
 * again. */
static enum fit_level last_level(const struct task *task) {
    return task->track_count >= TASK_FOLDS ? FIT_PHONES : FIT_GROUPS;
}

/* Each strength starts from the result of the firmer one. Returns the number of trials. */
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

/* Sets level, strength, held_out and held_out_unfitted by cross-validation. */
static void task_choose(struct task *task) {
    struct trial trials[TRIALS];
    size_t frames[TASK_FOLDS], count = 1, best = 0, chosen = 0, all = 0;
    double *x = mem_alloc(TASK_FOLDS * moves_count(task) * sizeof *x);
    task->strength = INFINITY;
    task->level = FIT_SCALE;
    moves_choose(task, FIT_SCALE);
    run_trial(task, x, task->options->then, &trials[0], frames);
    for (int i = 0; i < TASK_FOLDS; i++) /* the same for all trials */
        all += frames[i];
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
        double unresolved = sqrt(trials[best].sum / (double)(all ? all : 1)) + LEAST_GAIN;
        double most = fmax(trials[best].sum + standard_error(&trials[0], &trials[best], frames),
                           (double)all * unresolved * unresolved);
        while (trials[chosen].sum > most)
            chosen++;
    }
    task->level = trials[chosen].level;
    task->strength = trials[chosen].strength;
    task->fit->held_out[task->param] = sqrt(trials[chosen].sum / (double)(all ? all : 1));
    task->fit->held_out_unfitted[task->param] = sqrt(trials[0].sum / (double)(all ? all : 1));
    free(x);
}

/* More digits than a fit can determine. */
static json_t *number(double value) {
    return json_real(round(value * 1e4) / 1e4);
}

static json_t *coefficients(const struct coefficients *c) {
    return json_pack("{so so so so so so so so so so so so}", "t", number(c->t), "T", number(c->T), "alpha",
                     number(c->alpha), "k", number(c->k), "theta_bw", number(c->theta_bw), "theta_fw",
                     number(c->theta_fw), "c_bw", number(c->c_bw), "c_fw", number(c->c_fw), "p_bw",
                     number(c->p_bw), "p_fw", number(c->p_fw), "beta_bw", number(c->beta_bw), "beta_fw",
                     number(c->beta_fw));
}

/* Returns the member with that name, created as an empty object if missing. */
static json_t *member(json_t *object, const char *name) {
    json_t *found = json_object_get(object, name);
    if (!found) {
        found = json_object();
        json_object_set_new(object, name, found);
    }
    return found;
}

static bool is_changed(const struct coefficients *a, const struct coefficients *b) {
    return memcmp(a, b, sizeof *a) != 0;
}

static void add_entry(json_t *phones, const struct speech_pack *pack, const struct fit *fit,
                      const struct fit_entry *entry) {
    const struct speech_phone *phone = entry->phone;
    char *const *contexts = phone->group->vowel ? pack->vowel_contexts : pack->consonant_contexts;
    bool changed = false;
    for (size_t p = 0; p < PARAM_COUNT; p++)
        changed |= fit->fitted[p] && !fit->kept[p];
    if (!changed)
        return;
    json_t *own = member(phones, phone->ipa);
    json_object_set_new(own, "sampa", json_string(phone->sampa));
    json_object_set_new(own, "like", json_string(phone->ipa)); /* inherits group, contact and the rest */
    json_t *targets = member(own, "targets");
    for (size_t p = 0; p < PARAM_COUNT; p++) {
        size_t at = entry->context * PARAM_COUNT + p;
        if (!fit->fitted[p] || fit->kept[p])
            continue;
        json_object_set_new(member(targets, speech_params[p]), contexts[entry->context],
                            coefficients(&phone->plain[at]));
        if (phone->group->vowel && is_changed(&phone->plain[at], &phone->stressed[at]))
            json_object_set_new(member(member(own, "stressed"), speech_params[p]), contexts[entry->context],
                                coefficients(&phone->stressed[at]));
    }
}

static json_t *texts(char *const *list) {
    json_t *array = json_array();
    for (; *list; list++)
        json_array_append_new(array, json_string(*list));
    return array;
}

json_t *fit_pack(const struct speech_pack *pack, const struct fit *fit, const struct fit_names *names) {
    json_t *phones = json_object();
    for (size_t i = 0; i < fit->entry_count; i++)
        add_entry(phones, pack, fit, &fit->entries[i]);
    for (size_t i = 0; i < fit->other_count; i++)
        add_entry(phones, pack, fit, &fit->others[i]);
    return json_pack("{ss ss ss s[s] so so so}", "tag", names->tag, "name", names->name, "inherits",
                     names->inherits, "sources", names->source, "voices", texts(pack->voices),
                     "abbreviations", texts(pack->abbreviations), "phones", phones);
}

const char *const fit_level_names[FIT_LEVELS] = {"scale", "all vowels, all consonants", "groups",
                                                 "groups and phones"};

static size_t find_entry(struct fit *fit, const struct speech_phone *phone, size_t context) {
    for (size_t i = 0; i < fit->entry_count; i++)
        if (fit->entries[i].phone == phone && fit->entries[i].context == context)
            return i;
    fit->entries = mem_grow(fit->entries, &fit->entry_cap, fit->entry_count + 1, sizeof *fit->entries);
    fit->entries[fit->entry_count] = (struct fit_entry){phone, context};
    return fit->entry_count++;
}

/* Calls find_entry for everything in the segments, and marks it in the list, if any. */
static void list_entries(struct fit *fit, const struct phone_segments *g, bool *uses) {
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

static bool has_entry(const struct fit *fit, const struct speech_phone *phone, size_t context) {
    for (size_t i = 0; i < fit->entry_count; i++)
        if (fit->entries[i].phone == phone && fit->entries[i].context == context)
            return true;
    return false;
}

/* Lists all phones in all contexts other than the entries. */
static void list_others(struct fit *fit, const struct speech_pack *pack) {
    for (const struct speech_pack *from = pack; from; from = from->base)
        for (size_t i = 0; i < from->phone_count; i++) {
            const struct speech_phone *phone = from->phones[i];
            if (!phone->group || speech_pack_phone(pack, phone->ipa, strlen(phone->ipa)) != phone)
                continue;
            size_t contexts = phone->group->vowel ? pack->vowel_context_count : pack->consonant_context_count;
            for (size_t c = 0; c < contexts; c++) {
                if (has_entry(fit, phone, c))
                    continue;
                fit->others =
                    mem_grow(fit->others, &fit->other_cap, fit->other_count + 1, sizeof *fit->others);
                fit->others[fit->other_count++] = (struct fit_entry){phone, c};
            }
        }
}

/* Makes tracks with segments, entries and folds. */
static struct fit_track *open_tracks(const struct speech_pack *pack, const struct measured_speech *recordings,
                                     size_t count, const struct fit_options *options, struct fit *fit) {
    struct fit_track *tracks = mem_alloc((count + 1) * sizeof *tracks);
    for (size_t i = 0; i < count; i++) {
        tracks[i].recording = &recordings[i];
        measured_speech_segments(pack, &recordings[i], options->warn, options->ctx, &tracks[i].segments);
        list_entries(fit, &tracks[i].segments, NULL);
    }
    folds_make(tracks, count, options->rest_known);
    for (size_t i = 0; i < count; i++) {
        tracks[i].uses = mem_alloc(fit->entry_count + 1);
        list_entries(fit, &tracks[i].segments, tracks[i].uses);
    }
    return tracks;
}

static void close_tracks(struct fit_track *tracks, size_t count) {
    for (size_t i = 0; i < count; i++) {
        phone_segments_free(&tracks[i].segments);
        free(tracks[i].uses);
        free(tracks[i].folds);
    }
    free(tracks);
}

void fit_run(struct speech_pack *pack, const struct measured_speech *recordings, size_t count,
             const struct fit_options *options, struct fit *out) {
    *out = (struct fit){0};
    struct fit_track *tracks = open_tracks(pack, recordings, count, options, out);
    struct task task = {.pack = pack, .options = options, .fit = out, .tracks = tracks, .track_count = count};
    list_others(out, pack);
    task_open(&task);
    for (task.param = 0; task.param < PARAM_COUNT; task.param++)
        task_fit(&task, task_choose);
    task_close(&task);
    close_tracks(tracks, count);
}

void fit_errors(const struct speech_pack *pack, const struct measured_speech *recordings, size_t count,
                const struct fit_options *options, double errors[PARAM_COUNT],
                double shape_errors[PARAM_COUNT]) {
    struct fit_options quiet = *options;
    struct fit fit = {0};
    quiet.warn = NULL;
    struct fit_track *tracks = open_tracks(pack, recordings, count, &quiet, &fit);
    struct task task = {
        .pack = pack, .options = &quiet, .fit = &fit, .tracks = tracks, .track_count = count, .held = -1};
    for (task.param = 0; task.param < PARAM_COUNT; task.param++) {
        size_t frames;
        double sum = task_error(&task, -1, &frames);
        errors[task.param] = frames ? sqrt(sum / (double)frames) : NAN;
        sum = task_shape_error(&task, &frames);
        shape_errors[task.param] = frames ? sqrt(sum / (double)frames) : NAN;
    }
    close_tracks(tracks, count);
    fit_free(&fit);
}

void fit_shape(const struct speech_pack *pack, const struct measured_speech *recording,
               const struct fit_options *options, int param, double *out) {
    struct fit_options quiet = *options;
    struct fit fit = {0};
    quiet.warn = NULL;
    struct fit_track *tracks = open_tracks(pack, recording, 1, &quiet, &fit);
    struct task task = {.pack = pack,
                        .options = &quiet,
                        .param = param,
                        .fit = &fit,
                        .tracks = tracks,
                        .track_count = 1,
                        .held = -1};
    task_shape(&task, tracks, out);
    close_tracks(tracks, 1);
    fit_free(&fit);
}

void fit_free(struct fit *fit) {
    free(fit->entries);
    free(fit->others);
    *fit = (struct fit){0};
}
