/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TEI P5 (Guidelines, https://tei-c.org/guidelines/p5): the elements that literature is made of. */
#include "server/base/mem.h"
#include "server/library/tei_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Once for each name. */
static void tell_unknown(struct tei *t, const struct xml_walk *w, const char *name) {
    struct error e;
    for (size_t i = 0; i < t->unknown_count; i++)
        if (!strcmp(t->unknown[i], name))
            return;
    if (t->unknown_count == UNKNOWN_MAX)
        return;
    t->unknown[t->unknown_count++] = mem_strdup(name);
    error_at_line(&e, ERROR_UNKNOWN_ELEMENT, xml_walk_line(w), xml_walk_column(w),
                  "<%.60s> is read as its content", name);
    build_problem(t->b, &e, false);
}

static void start_inline(struct tei *t, struct tei_frame *f, const char **attributes) {
    struct builder *b = t->b;
    if (!build_is_open(b))
        return;
    f->opened = f->act == ACT_EMPHASIS || f->act == ACT_NAME || f->act == ACT_FOREIGN;
    if (f->act == ACT_EMPHASIS)
        build_mark(b, MARK_EMPHASIS, NULL);
    else if (f->act == ACT_NAME)
        build_mark(b, MARK_NAME, NULL);
    else if (f->act == ACT_FOREIGN)
        build_mark(b, MARK_FOREIGN, xml_attribute(attributes, "lang"));
    else if (f->act == ACT_BREAK && xml_attribute(attributes, "break"))
        ; /* inside a word: nothing is between its parts */
    else if (f->act == ACT_BREAK)
        build_text(b, " ", 1);
    else if (f->act == ACT_GAP)
        build_text(b, "[…]", strlen("[…]"));
}

/* In a note all that would be a block of its own is a line. */
static bool in_inset(const struct tei *t) {
    return build_is_open(t->b) && (build_kind(t->b) == BLOCK_NOTE || build_kind(t->b) == BLOCK_STAGE);
}

static void start_block(struct tei *t, struct tei_frame *f, const char **attributes) {
    struct builder *b = t->b;
    const char *n = xml_attribute(attributes, "n"), *rend = xml_attribute(attributes, "rend");
    if (in_inset(t) && f->act != ACT_NOTE && f->act != ACT_STAGE) {
        build_newline(b);
        return;
    }
    f->opened = true;
    switch (f->act) {
    case ACT_HEAD:
        build_block(b, BLOCK_HEAD);
        break;
    case ACT_PARAGRAPH:
    case ACT_ITEM:
        build_block(b, BLOCK_PARAGRAPH);
        build_top(b)->item = f->act == ACT_ITEM;
        break;
    case ACT_GROUP:
        build_block(b, BLOCK_VERSE);
        break;
    case ACT_LINE:
        build_line(b, n, rend && strstr(rend, "indent"));
        break;
    case ACT_SPEAKER:
        build_block(b, BLOCK_SPEAKER);
        break;
    case ACT_STAGE:
        build_inset(b, BLOCK_STAGE, NULL);
        break;
    default:
        build_inset(b, BLOCK_NOTE, n);
    }
}

static void on_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct tei *t = w->ctx;
    struct tei_frame *f = &t->frames[w->depth];
    const char *lang = xml_attribute(attributes, "lang");
    *f = (struct tei_frame){.act = tei_act_of(name)};
    snprintf(f->lang, sizeof f->lang, "%s", lang && *lang ? lang : t->frames[w->depth - 1].lang);
    t->b->lang = f->lang;
    if (w->depth == 1)
        t->is_tei = f->act == ACT_ROOT;
    if (t->skip || f->act == ACT_SKIP) {
        f->act = ACT_SKIP;
        t->skip++;
        return;
    }
    if (t->header || f->act == ACT_HEADER) {
        f->act = ACT_HEADER;
        t->header++;
        const char *ident = !strcmp(name, "language") ? xml_attribute(attributes, "ident") : NULL;
        if (ident && !*t->frames[1].lang)
            snprintf(t->frames[1].lang, sizeof t->frames[1].lang, "%s", ident);
        tei_header_start(t, w, name, attributes);
        return;
    }
    switch (f->act) {
    case ACT_ROOT:
        if (*f->lang && !*t->frames[1].lang)
            memcpy(t->frames[1].lang, f->lang, sizeof f->lang);
        break;
    case ACT_BODY:
        t->bodies++;
        build_section(t->b, 1);
        break;
    case ACT_DIV:
        build_section(t->b, ++t->divs);
        break;
    case ACT_SPEECH:
        build_end(t->b);
        break;
    case ACT_PAGE:
        build_page(t->b, xml_attribute(attributes, "n"));
        break;
    case ACT_EMPHASIS:
    case ACT_NAME:
    case ACT_FOREIGN:
    case ACT_BREAK:
    case ACT_GAP:
        start_inline(t, f, attributes);
        break;
    case ACT_UNKNOWN:
        tell_unknown(t, w, name);
        break;
    case ACT_PASS:
        break;
    default:
        start_block(t, f, attributes);
    }
}

static void end_block(struct tei *t, const struct tei_frame *f) {
    struct builder *b = t->b;
    if (f->act == ACT_LINE) {
        build_line_end(b);
    } else if (f->act == ACT_NOTE || f->act == ACT_STAGE) {
        build_inset_end(b);
    } else if (f->act == ACT_SPEAKER && build_is_open(b)) {
        const struct buf *text = &build_top(b)->text;
        char *who = mem_strndup(text->size ? (char *)text->data : "", text->size);
        build_end(b);
        build_speaker(b, who);
        free(who);
    } else {
        build_end(b);
    }
}

static void on_end(struct xml_walk *w, const char *name) {
    struct tei *t = w->ctx;
    struct tei_frame *f = &t->frames[w->depth];
    switch (f->act) {
    case ACT_SKIP:
        t->skip--;
        break;
    case ACT_HEADER:
        tei_header_end(t, w, name);
        t->header--;
        break;
    case ACT_BODY:
        build_section(t->b, 1);
        t->bodies--;
        break;
    case ACT_DIV:
        t->divs--;
        build_section(t->b, t->divs ? t->divs : 1);
        break;
    case ACT_SPEECH:
        build_end(t->b);
        build_speaker(t->b, NULL);
        break;
    case ACT_EMPHASIS:
    case ACT_NAME:
    case ACT_FOREIGN:
        if (f->opened)
            build_mark_end(t->b, f->act == ACT_EMPHASIS ? MARK_EMPHASIS
                                 : f->act == ACT_NAME   ? MARK_NAME
                                                        : MARK_FOREIGN);
        break;
    default:
        if (f->opened)
            end_block(t, f);
    }
    t->b->lang = t->frames[w->depth - 1].lang;
}

static void on_text(struct xml_walk *w, const char *text, size_t size) {
    struct tei *t = w->ctx;
    if (t->skip)
        return;
    if (t->header) {
        if (t->wanted && t->capture.size + size < 4096)
            buf_add(&t->capture, text, size);
        return;
    }
    if (!build_is_open(t->b) && t->bodies) {
        size_t i = 0;
        while (i < size && strchr(" \t\r\n", text[i]))
            i++;
        if (i < size)
            build_block(t->b, BLOCK_PARAGRAPH);
    }
    build_text(t->b, text, size);
}

static void on_entity(struct xml_walk *w, const char *name) {
    struct tei *t = w->ctx;
    struct error e;
    error_at_line(&e, ERROR_ENTITY, xml_walk_line(w), xml_walk_column(w),
                  "&%.60s; is not declared in the file: it is left out", name);
    build_problem(t->b, &e, false);
}

int tei_read(const char *data, size_t size, struct work_meta *meta, struct builder *b, struct error *e) {
    struct tei *t = mem_alloc(sizeof *t);
    struct xml_walk walk = {.ctx = t, .start = on_start, .end = on_end, .text = on_text, .entity = on_entity};
    t->b = b;
    t->meta = meta;
    meta->format = "tei";
    int result = xml_walk(&walk, data, size, e);
    if (!result && !t->is_tei)
        result = error_at_line(e, ERROR_BAD_WORK, 1, 1, "the root is neither TEI nor our own markup");
    while (build_is_open(b))
        build_end(b);
    b->lang = NULL;
    if (*t->frames[1].lang) {
        free(meta->lang);
        meta->lang = mem_strdup(t->frames[1].lang);
    }
    for (size_t i = 0; i < t->unknown_count; i++)
        free(t->unknown[i]);
    buf_free(&t->capture);
    free(t);
    return result;
}
