/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A first walk through a TEI document: of alternative encodings (choice, app) the best may come last. */
#include "server/base/mem.h"
#include "server/library/tei_internal.h"
#include <stdlib.h>
#include <string.h>

struct alternatives {
    bool is; /* this element has some */
    size_t number;
    unsigned children;
    int best;
};

struct outline_walk {
    struct tei_outline *outline;
    struct alternatives frames[WORK_DEPTH_MAX + 1];
    uint64_t bytes;
    bool stop;
};

/* The higher the better; of equal ones the first is read. Corrected, regularised and expanded comes before
 * what the edition corrects; what is certain before what is less so; no reading is left out for a note. */
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

static void on_start(struct xml_walk *w, const char *name, const char **attributes) {
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
    const char *id = !strcmp(name, "note") ? xml_attribute(attributes, "id") : NULL;
    if (id) {
        out->notes = mem_grow(out->notes, &out->note_cap, out->note_count + 1, sizeof *out->notes);
        out->notes[out->note_count++] = mem_strdup(id);
    }
    o->bytes += id ? strlen(id) + sizeof id : sizeof *out->choices;
    o->stop = o->bytes > WORK_BYTES_MAX;
}

static void on_end(struct xml_walk *w, const char *name) {
    (void)w;
    (void)name;
}

static void on_text(struct xml_walk *w, const char *text, size_t size) {
    struct outline_walk *o = w->ctx;
    (void)text;
    o->bytes += size;
    o->stop = o->bytes > 2 * (uint64_t)WORK_BYTES_MAX; /* entities in entities: reading ends before that */
}

static int compare(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

void tei_outline_read(struct tei_outline *outline, const char *data, size_t size) {
    struct outline_walk *o = mem_alloc(sizeof *o);
    struct error ignored;
    struct xml_walk walk = {.ctx = o, .start = on_start, .end = on_end, .text = on_text, .stop = &o->stop};
    o->outline = outline;
    xml_walk(&walk, data, size, &ignored);
    if (outline->note_count)
        qsort(outline->notes, outline->note_count, sizeof *outline->notes, compare);
    free(o);
}

void tei_outline_free(struct tei_outline *outline) {
    for (size_t i = 0; i < outline->note_count; i++)
        free(outline->notes[i]);
    free(outline->notes);
    free(outline->choices);
}

bool tei_outline_has_note(const struct tei_outline *outline, const char *id) {
    return outline->note_count &&
           bsearch(&id, outline->notes, outline->note_count, sizeof *outline->notes, compare);
}
