/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who speaks in a work, and how much; with what the source says of each. */
#include "server/base/mem.h"
#include "server/library/cast.h"
#include "server/library/words.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TALLY_MOST = 5000, OLD_YEARS = 60, CHILD_YEARS = 14, FIRST_BYTES = 160 };

bool cast_id_of_block(const struct block *block, char out[CAST_ID_BYTES]) {
    *out = '\0';
    if (block->who)
        snprintf(out, CAST_ID_BYTES, "%s", block->who);
    else if (block->speaker)
        cast_id_of_name(block->speaker, out);
    return *out;
}

/* Place of the id in the sorted list, or where it would be. */
static size_t place_of(const struct cast_tally *t, const char *id, bool *found) {
    size_t low = 0, high = t->count;
    *found = false;
    while (low < high) {
        size_t middle = (low + high) / 2;
        int order = strcmp(t->list[middle].id, id);
        if (!order) {
            *found = true;
            return middle;
        }
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The first words of a speech, on one line; NULL: it has none. */
static char *first_words(const char *text, size_t size) {
    struct buf out = {0};
    size_t at = 0, end;
    for (; at < size; at = end) {
        while (at < size && strchr(" \t\r\n", text[at]))
            at++;
        for (end = at; end < size && !strchr(" \t\r\n", text[end]); end++)
            ;
        if (end == at || out.size + 1 + end - at > FIRST_BYTES - strlen("\xE2\x80\xA6"))
            break;
        buf_add(&out, " ", out.size ? 1 : 0);
        buf_add(&out, text + at, end - at);
    }
    if (out.size && at < size)
        buf_add(&out, "\xE2\x80\xA6", 3); /* ... */
    if (out.size)
        buf_add(&out, "", 1);
    return (char *)out.data;
}

void cast_tally_add(struct cast_tally *t, const char *id, const char *name, const char *text, size_t size) {
    bool found;
    size_t at = place_of(t, id, &found);
    if (!found && t->count == TALLY_MOST)
        return;
    if (!found) {
        t->list = mem_grow(t->list, &t->cap, t->count + 1, sizeof *t->list);
        memmove(t->list + at + 1, t->list + at, (t->count - at) * sizeof *t->list);
        t->list[at] = (struct cast_tallied){.id = mem_strdup(id), .order = t->count++};
    }
    if (!t->list[at].name && name)
        t->list[at].name = mem_strdup(name);
    if (!t->list[at].first)
        t->list[at].first = first_words(text, size);
    t->list[at].passages++;
    t->list[at].characters += size;
}

void cast_tally_section(struct cast_tally *t, const struct section *section) {
    char id[CAST_ID_BYTES];
    for (size_t i = 0; i < section->count; i++)
        if (cast_id_of_block(&section->blocks[i], id))
            cast_tally_add(t, id, section->blocks[i].speaker, (char *)section->blocks[i].text.data,
                           section->blocks[i].text.size);
}

void cast_tally_free(struct cast_tally *t) {
    for (size_t i = 0; i < t->count; i++) {
        free(t->list[i].id);
        free(t->list[i].name);
        free(t->list[i].first);
    }
    free(t->list);
    *t = (struct cast_tally){0};
}

static const struct work_person *by_id(const struct work_meta *meta, const char *id, size_t size) {
    for (size_t i = 0; i < meta->person_count; i++)
        if (strlen(meta->persons[i].id) == size && !memcmp(meta->persons[i].id, id, size))
            return &meta->persons[i];
    return NULL;
}

/* How well a speaker's name fits a person's: 2: the same; 1: the beginning of one of its words ("Mir."). */
static int fit_of(const char *short_id, const char *name) {
    char whole[64];
    struct word word;
    cast_id_of_name(name, whole);
    if (!strcmp(whole, short_id))
        return 2;
    for (size_t at = 0; strlen(short_id) >= 2 && words_next(name, strlen(name), false, &at, &word);)
        if (!strncmp(word.folded, short_id, strlen(short_id)))
            return 1;
    return 0;
}

/* The person of that name; NULL: none, or several are meant equally. */
static const struct work_person *by_name(const struct work_meta *meta, const char *id) {
    const struct work_person *found = NULL;
    int best = 0;
    bool several = false;
    for (size_t i = 0; i < meta->person_count; i++) {
        int fit = fit_of(id, meta->persons[i].name);
        several = fit && fit == best ? true : fit > best ? false : several;
        if (fit > best) {
            best = fit;
            found = &meta->persons[i];
        }
    }
    return several ? NULL : found;
}

static void set_person(struct cast_member *m, const struct work_person *p) {
    if (*p->name) {
        free(m->name);
        m->name = mem_strdup(p->name);
    }
    m->about = p->about ? mem_strdup(p->about) : NULL;
    m->sex = p->sex;
    m->sex_from = p->sex == SEX_UNKNOWN ? FROM_NOTHING : FROM_SOURCE;
    m->age = !p->age                 ? AGE_UNKNOWN
             : p->age >= OLD_YEARS   ? AGE_OLD
             : p->age <= CHILD_YEARS ? AGE_CHILD
                                     : AGE_ADULT;
}

/* Several who speak together ("a+b"): their common sex. */
static void set_group(struct cast_member *m, const struct work_meta *meta) {
    enum person_sex sex = SEX_UNKNOWN;
    bool first = true;
    for (const char *at = m->id; *at; at += strspn(at, "+")) {
        size_t size = strcspn(at, "+");
        const struct work_person *p = by_id(meta, at, size);
        enum person_sex one = p ? p->sex : SEX_UNKNOWN;
        sex = first || sex == one ? one : SEX_UNKNOWN;
        first = false;
        at += size;
    }
    m->sex = sex;
    m->sex_from = sex == SEX_UNKNOWN ? FROM_NOTHING : FROM_SOURCE;
}

static int by_share(const void *a, const void *b) {
    const struct cast_tallied *x = a, *y = b;
    if (x->characters != y->characters)
        return x->characters > y->characters ? -1 : 1;
    return x->order < y->order ? -1 : 1;
}

void cast_tally_take(struct cast_tally *t, const struct work_meta *meta, struct cast *cast) {
    if (t->count)
        qsort(t->list, t->count, sizeof *t->list, by_share);
    for (size_t i = 0; i < t->count && i < CAST_MOST; i++) {
        const struct cast_tallied *one = &t->list[i];
        struct cast_member *m = cast_add(cast, one->id, one->name ? one->name : one->id);
        const struct work_person *p = by_id(meta, one->id, strlen(one->id));
        if (!p)
            p = by_name(meta, one->id);
        if (p)
            set_person(m, p);
        else if (strchr(one->id, '+'))
            set_group(m, meta);
        m->passages = one->passages;
        m->characters = one->characters;
        m->first = one->first ? mem_strdup(one->first) : NULL;
    }
    cast_tally_free(t);
}
