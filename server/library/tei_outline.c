/* SPDX-License-Identifier: GPL-3.0-or-later */
/* First pass over a TEI document, for what stands after the place where it is needed: which alternative of
 * choice and app to read, the ids of notes, which speeches name their speaker, and the persons' names. */
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/library/readers.h"
#include <stdlib.h>
#include <string.h>

struct alternatives {
    bool is; /* the element has alternatives */
    size_t number;
    unsigned children;
    int best;
};

enum { PERSON_NAME_MAX = 200 };

struct outline_walk {
    struct tei_outline *outline;
    struct alternatives frames[WORK_DEPTH_MAX + 1];
    size_t speeches[WORK_DEPTH_MAX + 1]; /* number + 1 of the speech around the element; 0: none */
    char *person;                        /* id of the person whose name is awaited */
    unsigned person_at, name_at;         /* depths of the person and of the name; 0: none */
    struct buf name;
    uint64_t bytes;
    bool stop;
};

/* Ranks an alternative; the first of the best is read. Corrections, regularisations and expansions come
 * before what they replace, certain readings before uncertain ones. Notes rank last. */
static int rank_of(const char *name, const char **attributes) {
    static const char *const chosen[] = {"corr", "reg", "expan", "ex", "lem", NULL};
    static const char *const original[] = {"sic", "orig", "abbr", "am", NULL};
    static const char *const none[] = {"note", "witDetail", "wit", "del", NULL};
    const char *cert = xml_attribute(attributes, "cert");
    int rank = xml_is_one(name, none)       ? 0
               : xml_is_one(name, chosen)   ? 30
               : xml_is_one(name, original) ? 10
                                            : 20;
    if (rank && cert)
        rank += !strcmp(cert, "high") ? 1 : !strcmp(cert, "low") ? -1 : 0;
    return rank;
}

/* A person of the header or of the cast list: its id, then its first name. */
static void start_person(struct outline_walk *o, const struct xml_walk *w, const char *name,
                         const char **attributes) {
    static const char *const persons[] = {"person", "personGrp", "castItem", "role", NULL};
    static const char *const names[] = {"persName", "name", "role", NULL};
    const char *id = xml_is_one(name, persons) ? xml_attribute(attributes, "id") : NULL;
    if (id && !o->name_at) {
        free(o->person);
        o->person = mem_strdup(id);
        o->person_at = w->depth;
    }
    if (o->person && !o->name_at && xml_is_one(name, names))
        o->name_at = w->depth;
    else if (o->name_at && o->name.size)
        buf_add(&o->name, " ", 1); /* separates the parts of a name */
}

/* Adds the name without needless white space. */
static void keep_person(struct outline_walk *o) {
    struct tei_outline *out = o->outline;
    char *name = mem_alloc(o->name.size + 1), *to = name;
    for (size_t i = 0; i < o->name.size; i++)
        if (!strchr(" \t\r\n", o->name.data[i]))
            *to++ = (char)o->name.data[i];
        else if (to > name && to[-1] != ' ')
            *to++ = ' ';
    to -= to > name && to[-1] == ' ';
    *to = '\0';
    if (to > name) {
        out->persons = mem_grow(out->persons, &out->person_cap, out->person_count + 1, sizeof *out->persons);
        out->persons[out->person_count++] = (struct tei_person){o->person, name};
        o->person = NULL;
    } else {
        free(name);
    }
}

static void outline_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct outline_walk *o = w->ctx;
    struct tei_outline *out = o->outline;
    struct alternatives *f = &o->frames[w->depth], *up = &o->frames[w->depth - 1];
    *f = (struct alternatives){.is = tei_act_of(name) == ACT_CHOICE};
    if (up->is) {
        int rank = rank_of(name, attributes);
        if (rank > up->best) {
            up->best = rank;
            out->choices[up->number] = up->children;
        }
        up->children++;
    }
    if (f->is) {
        f->number = out->count;
        out->choices = mem_grow(out->choices, &out->cap, out->count + 1, sizeof *out->choices);
        out->choices[out->count++] = 0;
    }
    o->speeches[w->depth] = o->speeches[w->depth - 1];
    if (tei_act_of(name) == ACT_SPEECH) {
        out->speeches =
            mem_grow(out->speeches, &out->speech_cap, out->speech_count + 1, sizeof *out->speeches);
        out->speeches[out->speech_count++] = false;
        o->speeches[w->depth] = out->speech_count;
    } else if (o->speeches[w->depth] && tei_act_of(name) == ACT_SPEAKER) {
        out->speeches[o->speeches[w->depth] - 1] = true;
    }
    start_person(o, w, name, attributes);
    const char *id = !strcmp(name, "note") ? xml_attribute(attributes, "id") : NULL;
    if (id) {
        out->notes = mem_grow(out->notes, &out->note_cap, out->note_count + 1, sizeof *out->notes);
        out->notes[out->note_count++] = mem_strdup(id);
    }
    o->bytes += id ? strlen(id) + sizeof id : sizeof *out->choices;
    o->stop = o->bytes > WORK_BYTES_MAX;
}

static void outline_end(struct xml_walk *w, const char *name) {
    struct outline_walk *o = w->ctx;
    (void)name;
    if (o->name_at == w->depth) {
        keep_person(o);
        buf_free(&o->name);
        o->name_at = 0;
    }
    if (o->person_at == w->depth) {
        free(o->person);
        o->person = NULL;
        o->person_at = 0;
    }
}

static void outline_text(struct xml_walk *w, const char *text, size_t size) {
    struct outline_walk *o = w->ctx;
    if (o->name_at && o->name.size + size < PERSON_NAME_MAX)
        buf_add(&o->name, text, size);
    o->bytes += size;
    o->stop = o->bytes > 2 * (uint64_t)WORK_BYTES_MAX; /* nested entities: the second pass stops earlier */
}

static int compare_ids(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static int compare_persons(const void *a, const void *b) {
    return strcmp(((const struct tei_person *)a)->id, ((const struct tei_person *)b)->id);
}

void tei_outline_read(struct tei_outline *outline, const char *data, size_t size) {
    struct outline_walk *o = mem_alloc(sizeof *o);
    struct error ignored;
    struct xml_walk walk = {
        .ctx = o, .start = outline_start, .end = outline_end, .text = outline_text, .stop = &o->stop};
    o->outline = outline;
    xml_walk(&walk, data, size, &ignored);
    if (outline->note_count)
        qsort(outline->notes, outline->note_count, sizeof *outline->notes, compare_ids);
    if (outline->person_count)
        qsort(outline->persons, outline->person_count, sizeof *outline->persons, compare_persons);
    free(o->person);
    buf_free(&o->name);
    free(o);
}

void tei_outline_free(struct tei_outline *outline) {
    for (size_t i = 0; i < outline->note_count; i++)
        free(outline->notes[i]);
    for (size_t i = 0; i < outline->person_count; i++) {
        free(outline->persons[i].id);
        free(outline->persons[i].name);
    }
    free(outline->persons);
    free(outline->notes);
    free(outline->speeches);
    free(outline->choices);
}

bool tei_outline_has_note(const struct tei_outline *outline, const char *id) {
    return outline->note_count &&
           bsearch(&id, outline->notes, outline->note_count, sizeof *outline->notes, compare_ids);
}

const char *tei_outline_person(const struct tei_outline *outline, const char *id) {
    const struct tei_person key = {.id = (char *)id};
    const struct tei_person *found =
        outline->person_count
            ? bsearch(&key, outline->persons, outline->person_count, sizeof key, compare_persons)
            : NULL;
    return found ? found->name : NULL;
}
