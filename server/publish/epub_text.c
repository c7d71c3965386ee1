/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/publish/epub_text.h"
#include <stdlib.h>
#include <string.h>

enum { NUMBERED_LINES = 5 }; /* every so many lines of verse show their number */

struct page {
    struct buf *out;
    const struct section *section;
    const struct recital_part *part;
    const char *lang;
    size_t unit; /* that comes next */
};

static void put(struct page *p, const char *text) {
    epub_escape(p->out, text, strlen(text));
}

static void put_lang(struct page *p, const char *lang) {
    if (!lang || !strcmp(lang, p->lang))
        return;
    buf_printf(p->out, " lang=\"");
    put(p, lang);
    buf_printf(p->out, "\" xml:lang=\"");
    put(p, lang);
    buf_printf(p->out, "\"");
}

/* The units that begin before that byte of the block. */
static void put_stretch(struct page *p, size_t number, size_t from, size_t to) {
    const struct recital_part *part = p->part;
    size_t first = p->unit;
    while (p->unit < part->count && part->units[p->unit].block == number && part->units[p->unit].from < to)
        p->unit++;
    epub_stretch(p->out, p->section, &p->section->blocks[number], from, to, part->units, first, p->unit);
}

/* A paragraph with breaks is verse for readers without style sheets, too. */
static void put_verse(struct page *p, size_t number) {
    const struct block *b = &p->section->blocks[number];
    buf_printf(p->out, "<p class=\"verse\" id=\"%s\"", b->name);
    put_lang(p, b->lang);
    buf_printf(p->out, ">");
    for (size_t i = 0; i < b->line_count; i++) {
        const struct block_line *l = &b->lines[i];
        size_t n = b->first_line + i;
        buf_printf(p->out, "%s<span class=\"line%s\" id=\"l%zu\"", i ? "<br/>\n" : "", l->indent ? " in" : "",
                   n);
        if (l->n) {
            buf_printf(p->out, " data-n=\"");
            put(p, l->n);
            buf_printf(p->out, "\"");
        } else if (n % NUMBERED_LINES == 0) {
            buf_printf(p->out, " data-n=\"%zu\"", n);
        }
        buf_printf(p->out, ">");
        put_stretch(p, number, l->start, l->end);
        buf_printf(p->out, "</span>");
    }
    buf_printf(p->out, "</p>\n");
}

static void put_flowing(struct page *p, size_t number) {
    const struct block *b = &p->section->blocks[number];
    char head[4];
    snprintf(head, sizeof head, "h%u", b->level < 1 ? 1 : b->level > 6 ? 6 : b->level);
    const char *name = b->kind == BLOCK_HEAD ? head : b->kind == BLOCK_NOTE ? "aside" : "p";
    buf_printf(p->out, "<%s", name);
    if (*b->name)
        buf_printf(p->out, " id=\"%s\"", b->name);
    if (b->kind == BLOCK_NOTE)
        buf_printf(p->out, " epub:type=\"footnote\" role=\"doc-footnote\"");
    else if (b->kind == BLOCK_SPEAKER || b->kind == BLOCK_STAGE || b->item)
        buf_printf(p->out, " class=\"%s\"",
                   b->kind == BLOCK_SPEAKER ? "speaker"
                   : b->kind == BLOCK_STAGE ? "stage"
                                            : "item");
    put_lang(p, b->lang);
    buf_printf(p->out, ">");
    if (b->kind == BLOCK_NOTE && b->n) {
        buf_printf(p->out, "<span class=\"sign\">");
        put(p, b->n);
        buf_printf(p->out, "</span> ");
    }
    put_stretch(p, number, 0, b->text.size);
    buf_printf(p->out, "</%s>\n", name);
}

static void put_block(struct page *p, size_t number) {
    const struct block *b = &p->section->blocks[number];
    while (p->unit < p->part->count && p->part->units[p->unit].block < number)
        p->unit++;
    if (b->kind == BLOCK_VERSE && b->line_count) {
        put_verse(p, number);
    } else if (b->kind == BLOCK_PAGE) {
        buf_printf(p->out, "<div epub:type=\"pagebreak\" role=\"doc-pagebreak\" title=\"");
        put(p, b->n ? b->n : "");
        buf_printf(p->out, "\"></div>\n");
    } else {
        put_flowing(p, number);
    }
}

void epub_xhtml(struct buf *out, const struct section *section, const struct recital_part *part,
                const char *lang) {
    struct page p = {out, section, part, lang, 0};
    buf_printf(out,
               "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE html>\n<html "
               "xmlns=\"http://www.w3.org/1999/xhtml\" xmlns:epub=\"http://www.idpf.org/2007/ops\" lang=\"");
    put(&p, lang);
    buf_printf(out, "\" xml:lang=\"");
    put(&p, lang);
    buf_printf(out, "\">\n<head>\n<title>");
    if (section->title && *section->title)
        put(&p, section->title);
    else
        buf_printf(out, "%u", section->number);
    buf_printf(out, "</title>\n<link rel=\"stylesheet\" type=\"text/css\" "
                    "href=\"style.css\"/>\n</head>\n<body id=\"all\">\n");
    for (size_t i = 0; i < section->count; i++)
        put_block(&p, i);
    buf_printf(out, "</body>\n</html>\n");
}

void epub_clock(struct buf *out, uint64_t ms) {
    buf_printf(out, "%llu:%02u:%02u.%03u", (unsigned long long)(ms / 3600000), (unsigned)(ms / 60000 % 60),
               (unsigned)(ms / 1000 % 60), (unsigned)(ms % 1000));
}

static uint64_t ms_of(uint64_t samples, uint32_t rate) {
    return samples * 1000 / rate;
}

uint64_t epub_smil(struct buf *out, unsigned section, const struct recital_part *part, uint32_t rate) {
    uint64_t whole = rate ? ms_of(part->samples, rate) : 0, from = 0;
    if (!part->count || !whole)
        return 0;
    buf_printf(out,
               "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<smil xmlns=\"http://www.w3.org/ns/SMIL\" "
               "xmlns:epub=\"http://www.idpf.org/2007/ops\" version=\"3.0\">\n<body>\n<seq id=\"all\" "
               "epub:textref=\"s%u.xhtml#all\">\n",
               section);
    for (size_t i = 0; i < part->count; i++) {
        uint64_t to = i + 1 < part->count ? ms_of(part->units[i + 1].start, rate) : whole;
        if (to <= from)
            continue; /* heard in less than a millisecond: with the next */
        buf_printf(out, "<par id=\"p%zu\"><text src=\"s%u.xhtml#w%zu\"/><audio src=\"s%u.mp3\" clipBegin=\"",
                   i + 1, section, i + 1, section);
        epub_clock(out, from);
        buf_printf(out, "\" clipEnd=\"");
        epub_clock(out, to);
        buf_printf(out, "\"/></par>\n");
        from = to;
    }
    buf_printf(out, "</seq>\n</body>\n</smil>\n");
    return whole;
}
