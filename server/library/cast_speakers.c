/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who speaks a text, in the syntax of a request (`speakers` of speak). */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/library/cast.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* m NULL: somebody who is not in the cast. */
static json_t *entry_of(const struct cast_member *m, const char *id, bool voices) {
    json_t *entry = json_pack("{ss}", "id", id);
    const char *name = m && m->name ? m->name : id;
    if (*name)
        json_object_set_new(entry, "name", json_string(name));
    if (!m || !voices)
        return entry;
    if (m->voice)
        json_object_set_new(entry, "voice", json_string(m->voice));
    if (m->affect)
        json_object_set_new(entry, "affect", json_string(m->affect));
    json_object_set_new(entry, "pitch", json_real(m->pitch));
    json_object_set_new(entry, "rate", json_real(m->rate));
    return entry;
}

static void add_range(struct buf *at, size_t start, size_t end) {
    if (start < end)
        buf_printf(at, "%s%zu-%zu", at->size ? " " : "", start, end);
}

/* Adds the entry with its ranges, and frees both. */
static void add_entry(json_t *list, json_t *entry, struct buf *at) {
    if (at->size) {
        json_object_set_new(entry, "at", json_stringn((char *)at->data, at->size));
        json_array_append(list, entry);
    }
    json_decref(entry);
    buf_free(at);
}

/* The narrator's manner, if the file beside the work gives it one. */
static void add_narrator(json_t *list, const struct cast *cast, const struct cast_speech *speeches,
                         size_t count) {
    const struct cast_member *m = &cast->narrator;
    struct buf at = {0};
    size_t end = 0;
    if (!m->voice && !m->affect && m->pitch == 1 && m->rate == 1)
        return;
    for (size_t i = 0; i < count; i++) {
        add_range(&at, end, speeches[i].start);
        end = speeches[i].end;
    }
    add_range(&at, end, UINT32_MAX);
    add_entry(list, entry_of(m, "", true), &at);
}

static const char *affect_of(const struct cast_speech *speech) {
    return speech->affect ? speech->affect : "";
}

static int by_who(const void *a, const void *b) {
    const struct cast_speech *x = *(struct cast_speech *const *)a, *y = *(struct cast_speech *const *)b;
    int order = strcmp(x->who, y->who);
    order = order ? order : strcmp(affect_of(x), affect_of(y));
    return order ? order : (x->start > y->start) - (x->start < y->start);
}

char *cast_speakers(const struct cast *cast, const struct cast_speech *speeches, size_t count, bool voices) {
    const struct cast_speech **sorted = mem_alloc((count + 1) * sizeof(struct cast_speech *));
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        sorted[i] = &speeches[i];
    if (count)
        qsort(sorted, count, sizeof *sorted, by_who);
    for (size_t i = 0; i < count;) {
        const char *who = sorted[i]->who, *affect = affect_of(sorted[i]);
        struct buf at = {0};
        for (; i < count && !strcmp(sorted[i]->who, who) && !strcmp(affect_of(sorted[i]), affect); i++)
            add_range(&at, sorted[i]->start, sorted[i]->end);
        json_t *entry = entry_of(cast_find(cast, who), who, voices);
        if (voices && *affect)
            json_object_set_new(entry, "affect", json_string(affect));
        add_entry(list, entry, &at);
    }
    if (voices)
        add_narrator(list, cast, speeches, count);
    char *text = json_array_size(list) ? json_dumps(list, JSON_COMPACT | JSON_REAL_PRECISION(4)) : NULL;
    json_decref(list);
    free(sorted);
    return text;
}

void cast_speeches_free(struct cast_speech *speeches, size_t count) {
    for (size_t i = 0; i < count; i++)
        free(speeches[i].who), free(speeches[i].affect);
    free(speeches);
}
