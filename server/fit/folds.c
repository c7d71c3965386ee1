/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/folds.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

/* The phones that are spoken, each once. */
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

/* Those of a group come after each other, and so into different parts: the others of the group can tell of
 * the one that is held out. */
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

bool folds_tell(const struct task *task, const struct fit_track *t, size_t frame) {
    const bool *unseen = t->recording->unseen[task->param];
    return t->folds[frame] != FOLD_NONE && !(unseen && unseen[frame]);
}
