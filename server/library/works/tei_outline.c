/* SPDX-License-Identifier: GPL-3.0-or-later */
/* First pass over a TEI document, for what stands after the place where it is needed: which alternative of
 * choice and app to read, the ids of notes, which speeches name their speaker, and the persons' names. */
#include "server/base/mem.h"
#include "server/library/works/readers.h"
#include <stdlib.h>
#include <string.h>

struct alternatives {
    bool is; /* the element has alternatives */
    size_t number;
    unsigned children;
    int best;
};

struct outline_walk {
    struct tei_outline *outline;
    struct alternatives frames[WORK_DEPTH_MAX + 1];
    size_t speeches[WORK_DEPTH_MAX + 1]; /* number + 1 of the speech around the element; 0: none */
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
    tei_persons_start(&out->persons, w->depth, name, attributes);
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
    tei_persons_end(&o->outline->persons, w->depth);
}

static void outline_text(struct xml_walk *w, const char *text, size_t size) {
    struct outline_walk *o = w->ctx;
    tei_persons_text(&o->outline->persons, text, size);
    o->bytes += size;
    o->stop = o->bytes > 2 * (uint64_t)WORK_BYTES_MAX; /* nested entities: the second pass stops earlier */
}

static int compare_ids(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
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
    tei_persons_done(&outline->persons);
    free(o);
}

void tei_outline_free(struct tei_outline *outline) {
    for (size_t i = 0; i < outline->note_count; i++)
        free(outline->notes[i]);
    tei_persons_free(&outline->persons);
    free(outline->notes);
    free(outline->speeches);
    free(outline->choices);
}

bool tei_outline_has_note(const struct tei_outline *outline, const char *id) {
    return outline->note_count &&
           bsearch(&id, outline->notes, outline->note_count, sizeof *outline->notes, compare_ids);
}
