/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/book_texts.h"
#include "server/base/mem.h"
#include <expat.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH_MAX = 256, IDS_MAX = 200000, PIECE = 1 << 20 };

struct walk {
    struct book_texts *texts;
    XML_Parser parser;
    size_t depth, open[DEPTH_MAX]; /* open: index of the element's text + 1; 0: it has no id */
};

const char *book_local_name(const char *name) {
    const char *colon = strrchr(name, ':');
    return colon ? colon + 1 : name;
}

/* Within such an element a word goes on. */
static bool is_inline(const char *name) {
    static const char *const names[] = {"a",     "abbr", "b",     "bdi",  "bdo",    "cite", "code", "dfn",
                                        "em",    "font", "i",     "ins",  "kbd",    "mark", "q",    "ruby",
                                        "s",     "samp", "small", "span", "strong", "sub",  "sup",  "time",
                                        "tspan", "tt",   "u",     "var",  "wbr"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(name, names[i]))
            return true;
    return false;
}

static void on_start(void *ctx, const char *name, const char **attributes) {
    struct walk *w = ctx;
    struct book_texts *t = w->texts;
    const char *id = NULL;
    for (; *attributes && !id; attributes += 2)
        if (!strcmp(book_local_name(attributes[0]), "id"))
            id = attributes[1];
    if (!is_inline(book_local_name(name)))
        buf_add(&t->text, " ", 1);
    size_t at = w->depth++;
    if (at >= DEPTH_MAX) {
        XML_StopParser(w->parser, XML_FALSE);
        return;
    }
    w->open[at] = 0;
    if (id && t->count < IDS_MAX) {
        t->list = mem_grow(t->list, &t->cap, t->count + 1, sizeof *t->list);
        t->list[t->count++] = (struct book_text){mem_strdup(id), t->text.size, t->text.size};
        w->open[at] = t->count;
    }
}

static void on_end(void *ctx, const char *name) {
    struct walk *w = ctx;
    if (w->depth-- > DEPTH_MAX)
        return;
    if (w->open[w->depth])
        w->texts->list[w->open[w->depth] - 1].to = w->texts->text.size;
    if (!is_inline(book_local_name(name)))
        buf_add(&w->texts->text, " ", 1);
}

static void on_text(void *ctx, const char *text, int size) {
    buf_add(&((struct walk *)ctx)->texts->text, text, (size_t)size);
}

static void on_entity(void *ctx, const char *name, int is_parameter) {
    (void)name, (void)is_parameter;
    buf_add(&((struct walk *)ctx)->texts->text, " ", 1);
}

static int compare(const void *a, const void *b) {
    return strcmp(((const struct book_text *)a)->id, ((const struct book_text *)b)->id);
}

void book_texts_read(struct book_texts *t, const char *data, size_t size) {
    struct walk *w = mem_alloc(sizeof *w);
    w->texts = t;
    w->parser = XML_ParserCreate(NULL);
    XML_SetUserData(w->parser, w);
    XML_SetElementHandler(w->parser, on_start, on_end);
    XML_SetCharacterDataHandler(w->parser, on_text);
    XML_SetSkippedEntityHandler(w->parser, on_entity);
    XML_SetParamEntityParsing(w->parser, XML_PARAM_ENTITY_PARSING_NEVER);
    XML_UseForeignDTD(w->parser, XML_TRUE);
    enum XML_Status status = XML_STATUS_OK;
    for (size_t at = 0; at < size && status == XML_STATUS_OK; at += PIECE) {
        size_t n = size - at < PIECE ? size - at : PIECE;
        status = XML_Parse(w->parser, data + at, (int)n, at + n == size);
    }
    XML_ParserFree(w->parser);
    free(w);
    if (t->count)
        qsort(t->list, t->count, sizeof *t->list, compare);
}

void book_texts_free(struct book_texts *t) {
    for (size_t i = 0; i < t->count; i++)
        free(t->list[i].id);
    free(t->list);
    buf_free(&t->text);
    *t = (struct book_texts){0};
}

const struct book_text *book_texts_find(const struct book_texts *t, const char *id) {
    const struct book_text key = {.id = (char *)id};
    return t->count ? bsearch(&key, t->list, t->count, sizeof key, compare) : NULL;
}
