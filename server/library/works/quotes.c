/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quotation marks of elements that quote by markup alone (HTML's `q`, TEI's `q` and `said`), as a browser or
 * a style sheet would write them. */
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include <stdio.h>
#include <string.h>

/* Outer and inner marks by language (CLDR's delimiters); the last row is that of all others. */
static const struct {
    const char *langs, *marks[4];
} usages[] = {
    {" it fr es eu gl ca el ru uk ", {"«", "»", "“", "”"}},
    {" de cs sk sl hr sr bg is lt ", {"„", "“", "‚", "‘"}},
    {"", {"“", "”", "‘", "’"}},
};

static const char *mark_of(const char *lang, unsigned which) {
    char primary[12];
    snprintf(primary, sizeof primary, " %.*s ", (int)strcspn(lang, "-"), lang);
    for (size_t i = 0;; i++)
        if (!*usages[i].langs || (*lang && strstr(usages[i].langs, primary)))
            return usages[i].marks[which];
}

/* True for quotation marks, and for dashes, which mark speech as well. */
static bool is_mark(uint32_t cp) {
    return cp == '"' || cp == '\'' || cp == '-' || cp == 0xAB || cp == 0xBB ||
           (cp >= 0x2010 && cp <= 0x201F) || cp == 0x2039 || cp == 0x203A || (cp >= 0x300C && cp <= 0x300F);
}

/* True when a quotation mark stands right before, or nothing but a dash. */
static bool follows_mark(struct builder *b) {
    const struct block *block = build_top(b);
    size_t at = block->text.size, from = at;
    uint32_t cp = 0;
    while (from && (block->text.data[--from] & 0xC0) == 0x80)
        ;
    if (at)
        utf8_next((const char *)block->text.data + from, at - from, &cp);
    bool dash = cp == '-' || (cp >= 0x2010 && cp <= 0x2015);
    return at && is_mark(cp) && (dash ? !from : !b->space);
}

static bool is_here(struct builder *b, const struct quote *q) {
    const struct block *top = build_top(b);
    return top && q->section == b->sections && !strcmp(q->block, top->name);
}

void quotes_begin(struct quotes *quotes, struct builder *b, const char *lang) {
    if (quotes->depth++ >= QUOTES_MAX)
        return;
    struct quote *q = &quotes->list[quotes->depth - 1];
    const struct block *top = build_top(b);
    *q = (struct quote){.waits = top && *top->name, .section = b->sections};
    if (q->waits)
        snprintf(q->block, sizeof q->block, "%s", top->name);
    snprintf(q->lang, sizeof q->lang, "%s", *lang ? lang : b->work_lang ? b->work_lang : "");
}

size_t quotes_text(struct quotes *quotes, struct builder *b, const char *text, size_t size) {
    size_t white = 0;
    uint32_t cp = 0;
    while (white < size && strchr(" \t\r\n", text[white]))
        white++;
    if (white == size)
        return 0;
    utf8_next(text + white, size - white, &cp);
    bool opened = false;
    for (unsigned i = 0; i < quotes->depth && i < QUOTES_MAX; i++) {
        struct quote *q = &quotes->list[i];
        if (!q->waits)
            continue;
        q->waits = false;
        if (!is_here(b, q) || is_mark(cp) || (!opened && follows_mark(b)))
            continue;
        if (!opened)
            build_text(b, text, white);
        const char *mark = mark_of(q->lang, i % 2 ? 2 : 0);
        build_text(b, mark, strlen(mark));
        q->opened = opened = true;
    }
    return opened ? white : 0;
}

void quotes_end(struct quotes *quotes, struct builder *b) {
    if (!quotes->depth || quotes->depth-- > QUOTES_MAX)
        return;
    const struct quote *q = &quotes->list[quotes->depth];
    if (!q->opened || !is_here(b, q))
        return;
    const char *mark = mark_of(q->lang, quotes->depth % 2 ? 3 : 1);
    bool space = b->space;
    b->space = false;
    build_text(b, mark, strlen(mark));
    b->space = space;
}
