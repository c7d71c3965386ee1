/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text in APML, JSML or SSML: one paragraph. What is shown has a space for each UTF-16 unit of a tag, so
 * that the places of what is spoken are its own. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/readers.h"
#include "server/library/xml_walk.h"
#include <stdlib.h>
#include <string.h>

struct marked {
    const char *data;
    struct buf out;
    size_t at; /* so far of the data */
    struct work_meta *meta;
};

static void blank(struct marked *m, size_t to) {
    while (m->at < to) {
        uint32_t cp;
        size_t n = utf8_next(m->data + m->at, to - m->at, &cp);
        buf_add(&m->out, "  ", n == 4 ? 2 : 1);
        m->at += n ? n : 1;
    }
}

static void on_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct marked *m = w->ctx;
    const char *lang = w->depth == 1 ? xml_attribute(attributes, "lang") : NULL;
    (void)name;
    if (lang && *lang) {
        free(m->meta->lang);
        m->meta->lang = mem_strdup(lang);
    }
}

static void on_end(struct xml_walk *w, const char *name) {
    (void)w;
    (void)name;
}

static void on_text(struct xml_walk *w, const char *text, size_t size) {
    struct marked *m = w->ctx;
    size_t from = (size_t)XML_GetCurrentByteIndex(w->parser);
    size_t length = (size_t)XML_GetCurrentByteCount(w->parser);
    if (from < m->at) /* the rest of a long piece, which came whole */
        return;
    blank(m, from);
    if (m->data[from] == '&') { /* the character, and spaces for the rest of its name */
        uint32_t cp;
        size_t units = utf8_next(text, size, &cp) == 4 ? 2 : 1;
        buf_add(&m->out, text, size);
        m->at += units;
        blank(m, from + length);
    } else {
        buf_add(&m->out, m->data + from, length);
        m->at = from + length;
    }
}

int markup_work_read(const char *data, size_t size, const char *markup, struct work_meta *meta,
                     struct builder *b, struct error *e) {
    struct marked m = {.data = data, .meta = meta};
    struct xml_walk walk = {.ctx = &m, .start = on_start, .end = on_end, .text = on_text};
    meta->format = markup;
    if (size > BLOCK_BYTES_MAX)
        return error_set(e, ERROR_BAD_WORK, "a text in %s may have %d bytes", markup, BLOCK_BYTES_MAX);
    int result = xml_walk(&walk, data, size, e);
    blank(&m, size);
    if (!result && m.out.size) {
        b->lang = meta->lang;
        build_block(b, BLOCK_PARAGRAPH);
        b->keep = true;
        build_text(b, (char *)m.out.data, m.out.size);
        b->keep = false;
        build_top(b)->source = mem_strndup(data, size);
        build_top(b)->markup = markup;
        build_end(b);
        b->lang = NULL;
    }
    buf_free(&m.out);
    return result;
}
