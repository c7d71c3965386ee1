/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/fit.h"
#include "server/base/mem.h"
#include "server/fit/task.h"
#include "server/fit/unknowns.h"
#include <stdlib.h>
#include <string.h>

static size_t find_entry(struct fit *fit, const struct speech_phone *phone, size_t context) {
    for (size_t i = 0; i < fit->entry_count; i++)
        if (fit->entries[i].phone == phone && fit->entries[i].context == context)
            return i;
    fit->entries = mem_grow(fit->entries, &fit->entry_cap, fit->entry_count + 1, sizeof *fit->entries);
    fit->entries[fit->entry_count] = (struct fit_entry){phone, context};
    return fit->entry_count++;
}

/* Calls find_entry for all that the gestures contain, and notes it where there is a list. */
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

void fit_run(struct speech_pack *pack, const struct measured_speech *recordings, size_t count,
             const struct fit_options *options, struct fit *out) {
    *out = (struct fit){0};
    struct track *tracks = mem_alloc((count + 1) * sizeof *tracks);
    for (size_t i = 0; i < count; i++) {
        tracks[i].recording = &recordings[i];
        measured_speech_segments(pack, &recordings[i], options->warn, options->ctx, &tracks[i].gestures);
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
            task_fit(&task);
        }
        task_measure(&task);
    }
    for (size_t i = 0; i < count; i++) {
        phone_segments_free(&tracks[i].gestures);
        free(tracks[i].uses);
    }
    free(tracks);
    free(task.own);
}

void fit_free(struct fit *fit) {
    free(fit->entries);
    *fit = (struct fit){0};
}
