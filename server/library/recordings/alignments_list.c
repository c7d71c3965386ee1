/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which recordings there are, and what is known of each. */
#include "server/base/mem.h"
#include "server/library/library_files.h"
#include "server/library/recordings/alignments_internal.h"
#include "server/library/recordings/library_voices.h"
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void recorded_works_free(struct recorded_works *works) {
    for (size_t i = 0; i < works->count; i++) {
        free(works->list[i].path);
        free(works->list[i].sound);
    }
    free(works->list);
    *works = (struct recorded_works){0};
}

void alignments_drop(struct alignment *list, size_t count) {
    for (size_t i = 0; i < count; i++) {
        free(list[i].of.path);
        free(list[i].of.sound);
        free(list[i].why);
    }
    free(list);
}

static int compare(const void *a, const void *b) {
    return strcmp(((const struct recorded_work *)a)->work, ((const struct recorded_work *)b)->work);
}

struct alignment *alignments_find(const struct alignments *a, const char *work) {
    size_t low = 0, high = a->count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        int order = strcmp(a->list[middle].of.work, work);
        if (!order)
            return &a->list[middle];
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return NULL;
}

static bool is_same(const struct recorded_work *a, const struct recorded_work *b) {
    return !strcmp(a->path, b->path) && !strcmp(a->sound, b->sound) && a->size == b->size &&
           a->modified == b->modified && a->sound_size == b->sound_size &&
           a->sound_modified == b->sound_modified;
}

bool alignments_take(struct alignments *a) {
    pthread_mutex_lock(&a->mutex);
    struct recorded_works seen = a->seen;
    bool any = a->is_seen;
    a->seen = (struct recorded_works){0};
    a->is_seen = false;
    pthread_mutex_unlock(&a->mutex);
    if (!any)
        return false;
    if (seen.count)
        qsort(seen.list, seen.count, sizeof *seen.list, compare);
    struct alignment *list = mem_alloc((seen.count + 1) * sizeof *list);
    for (size_t i = 0; i < seen.count; i++) {
        struct alignment *one = &list[i], *before = alignments_find(a, seen.list[i].work);
        *one = (struct alignment){.of = seen.list[i], .changed = true};
        if (before && is_same(&before->of, &one->of)) {
            one->changed = before->changed;
            one->attempts = before->attempts;
            one->not_before = before->not_before;
        }
        if (before) {
            one->state = before->state;
            one->share = before->share;
            one->given = before->given;
            one->why = before->why ? mem_strdup(before->why) : NULL;
        }
    }
    free(seen.list); /* its texts are the new list's */
    struct alignment *old = a->list;
    size_t old_count = a->count;
    pthread_mutex_lock(&a->mutex);
    a->list = list;
    a->count = seen.count;
    pthread_mutex_unlock(&a->mutex);
    alignments_drop(old, old_count);
    return true;
}

void alignments_set(struct alignments *a, struct alignment *one, enum alignment_state state,
                    const char *why) {
    char *copy = why ? mem_strdup(why) : NULL;
    pthread_mutex_lock(&a->mutex);
    free(one->why);
    one->why = copy;
    one->state = state;
    one->share = 0;
    pthread_mutex_unlock(&a->mutex);
}

/* Its voice is made ready, if it has another text now; and then what was kept of it. */
static void look_at(struct alignments *a, struct alignment *one) {
    struct error e;
    char text[512], *why = NULL;
    char *sound = library_file_path(a->folder, one->of.sound);
    int ready = library_voice_prepare(a->folder, one->of.path, one->of.work, a->voices, a->lang, a->reader,
                                      &a->stop, &e);
    one->given = ready > 0 && library_voice_has_times(a->voices, one->of.work);
    if (ready < 0)
        alignments_set(a, one, ALIGNMENT_FAILED, error_text(&e, text, sizeof text));
    else if (!ready)
        alignments_set(a, one, ALIGNMENT_FAILED, "the work cannot be read to its end");
    else if (one->given)
        alignments_set(a, one, ALIGNMENT_ALIGNED, NULL);
    else {
        enum alignment_state state = alignment_state_kept(a->voices, one->of.work, sound, &why);
        alignments_set(a, one, state, why);
    }
    one->changed = false;
    free(why);
    free(sound);
}

void alignments_look(struct alignments *a) {
    for (size_t i = 0; i < a->count && !atomic_load(&a->stop); i++)
        if (a->list[i].changed)
            look_at(a, &a->list[i]);
}
