/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/fit.h"
#include "server/base/mem.h"
#include "server/fit/folds.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/* Calls find_entry for all that the segments contain, and notes it where there is a list. */
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

/* All phones in all contexts but the entries. */
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

/* Tracks with their segments, and the entries and folds of them. */
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

void fit_free(struct fit *fit) {
    free(fit->entries);
    free(fit->others);
    *fit = (struct fit){0};
}
