/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/language_runs.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <ctype.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail(struct error *e) {
    return error_in_field(e, ERROR_BAD_FIELD, "languages",
                          "must be ranges \"START-END:LANG\" of the text, separated by spaces");
}

static bool is_lang(const char *lang, size_t size) {
    bool well = size && size < LANGUAGE_BYTES && isalpha((unsigned char)*lang);
    for (size_t i = 0; i < size; i++)
        well = well && (isalnum((unsigned char)lang[i]) || lang[i] == '-');
    return well;
}

static int compare(const void *a, const void *b) {
    const struct language_run *x = a, *y = b;
    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    return (x->to < y->to) - (x->to > y->to); /* the longer one first, as it encloses the other */
}

static void add(struct language_runs *runs, const struct language_run *of, size_t from, size_t to) {
    if (from >= to)
        return;
    runs->list = mem_grow(runs->list, &runs->cap, runs->count + 1, sizeof *runs->list);
    runs->list[runs->count] = *of;
    runs->list[runs->count].from = from;
    runs->list[runs->count++].to = to;
}

/* Splits the sorted runs where others begin inside them. Open runs form a stack, outermost first. */
static void flatten(struct language_runs *to, const struct language_runs *from) {
    size_t *open = mem_alloc((from->count + 1) * sizeof *open), depth = 0, at = 0;
    for (size_t i = 0; i <= from->count; i++) {
        size_t next = i < from->count ? from->list[i].from : SIZE_MAX;
        while (depth && at < next) {
            const struct language_run *top = &from->list[open[depth - 1]];
            size_t end = top->to < next ? top->to : next;
            add(to, top, at, end);
            at = end > at ? end : at;
            if (top->to > next)
                break;
            depth--;
        }
        at = next;
        open[depth++] = i;
    }
    free(open);
}

int language_runs_read(struct language_runs *runs, const char *written, const char *text, size_t size,
                       struct error *e) {
    struct language_runs all = {0};
    struct utf16_counter at = {0};
    *runs = (struct language_runs){0};
    for (const char *c = written + strspn(written, " "); *c; c += strspn(c, " ")) {
        struct language_run run = {0};
        size_t length = strcspn(c, " ");
        unsigned long start, end;
        int lang = 0;
        if (!isdigit((unsigned char)*c) || sscanf(c, "%9lu-%9lu:%n", &start, &end, &lang) != 2 || !lang ||
            start >= end || (size_t)lang > length || !is_lang(c + lang, length - (size_t)lang)) {
            language_runs_free(&all);
            return fail(e);
        }
        run.from = utf16_byte(&at, text, size, start);
        run.to = utf16_byte(&at, text, size, end);
        snprintf(run.lang, sizeof run.lang, "%.*s", (int)(length - (size_t)lang), c + lang);
        if (run.from < run.to) {
            all.list = mem_grow(all.list, &all.cap, all.count + 1, sizeof run);
            all.list[all.count++] = run;
        }
        c += length;
    }
    if (all.count) {
        qsort(all.list, all.count, sizeof *all.list, compare);
        flatten(runs, &all);
    }
    language_runs_free(&all);
    return 0;
}

void language_runs_free(struct language_runs *runs) {
    free(runs->list);
    *runs = (struct language_runs){0};
}
