/* SPDX-License-Identifier: GPL-3.0-or-later */
/* XHTML as EPUBs have it. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/readers.h"
#include "server/library/xml_walk.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum html_act { HTML_PASS, HTML_SKIP, HTML_HEAD, HTML_PARAGRAPH, HTML_ITEM, HTML_NOTE, HTML_MARK, HTML_PAGE };

struct html_frame {
    enum html_act act;
    bool opened, foreign;
    char lang[36];
};

struct html {
    struct html_frame frames[WORK_DEPTH_MAX + 1];
    struct builder *b;
    const char *name;
    unsigned skip, body;
};

/* Sets the line and says in which file of the archive. */
static void tell(struct html *h, const struct xml_walk *w, enum error_code code, const char *what,
                 const char *which) {
    struct error e;
    error_at_line(&e, code, xml_walk_line(w), xml_walk_column(w), "%.120s: %s %.60s", h->name, what, which);
    build_problem(h->b, &e, false);
}

static bool has_type(const char **attributes, const char *word) {
    const char *type = xml_attribute(attributes, "type"), *role = xml_attribute(attributes, "role");
    return (type && strstr(type, word)) || (role && strstr(role, word));
}

static enum html_act act_of(const char *name, const char **attributes) {
    static const char *const skipped[] = {"head",   "script", "style", "nav",    "svg",    "math",
                                          "img",    "audio",  "video", "object", "iframe", "form",
                                          "button", "input",  "rt",    NULL};
    static const char *const blocks[] = {"p",  "blockquote", "pre",     "figcaption", "dd", "dt",
                                         "td", "th",         "caption", "address",    NULL};
    static const char *const marks[] = {"em", "i", "b", "strong", "cite", "dfn", "u", NULL};
    if (has_type(attributes, "pagebreak"))
        return HTML_PAGE;
    if (has_type(attributes, "footnote") || has_type(attributes, "endnote") ||
        has_type(attributes, "rearnote"))
        return strcmp(name, "a") != 0 ? HTML_NOTE : HTML_PASS;
    if (xml_is_one(name, skipped))
        return HTML_SKIP;
    if (name[0] == 'h' && name[1] >= '1' && name[1] <= '6' && !name[2])
        return HTML_HEAD;
    if (xml_is_one(name, blocks))
        return HTML_PARAGRAPH;
    if (!strcmp(name, "li"))
        return HTML_ITEM;
    return xml_is_one(name, marks) ? HTML_MARK : HTML_PASS;
}

static bool in_note(const struct html *h) {
    return build_is_open(h->b) && build_kind(h->b) == BLOCK_NOTE;
}

/* The lines of a paragraph that has such are verse. */
static void break_line(struct html *h) {
    struct block *block = build_top(h->b);
    if (!block || block->kind == BLOCK_HEAD) {
        build_text(h->b, " ", 1);
    } else if (block->kind != BLOCK_PARAGRAPH && block->kind != BLOCK_VERSE) {
        build_newline(h->b);
    } else {
        if (block->kind == BLOCK_PARAGRAPH) {
            struct section *s = &h->b->section;
            block->kind = BLOCK_VERSE;
            s->counts[BLOCK_PARAGRAPH]--;
            snprintf(block->name, sizeof block->name, "g%u", ++s->counts[BLOCK_VERSE]);
            block->lines = mem_grow(block->lines, &block->line_cap, 1, sizeof *block->lines);
            block->lines[block->line_count++] = (struct block_line){.end = block->text.size};
        }
        build_line(h->b, NULL, false);
    }
}

static void start_block(struct html *h, struct html_frame *f, const char *name, const char **attributes) {
    struct builder *b = h->b;
    const char *label = xml_attribute(attributes, "title");
    if (f->act == HTML_PAGE) {
        build_page(b, label ? label : xml_attribute(attributes, "aria-label"));
        f->act = HTML_SKIP;
        h->skip++;
    } else if (in_note(h) && f->act != HTML_MARK) {
        build_newline(b);
    } else if (f->act == HTML_HEAD) {
        unsigned level = (unsigned)(name[1] - '0');
        if (level <= 3 && b->section.count)
            build_section(b, level);
        build_block(b, BLOCK_HEAD);
        build_top(b)->level = level;
        f->opened = true;
    } else if (f->act == HTML_PARAGRAPH || f->act == HTML_ITEM) {
        build_block(b, BLOCK_PARAGRAPH);
        build_top(b)->item = f->act == HTML_ITEM;
        f->opened = true;
    } else if (f->act == HTML_NOTE) {
        build_end(b);
        build_inset(b, BLOCK_NOTE, NULL);
        f->opened = true;
    } else if (f->act == HTML_MARK && build_is_open(b)) {
        build_mark(b, MARK_EMPHASIS, NULL);
        f->opened = true;
    }
}

static void on_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct html *h = w->ctx;
    struct html_frame *f = &h->frames[w->depth];
    const char *lang = xml_attribute(attributes, "lang");
    *f = (struct html_frame){.act = act_of(name, attributes)};
    snprintf(f->lang, sizeof f->lang, "%s", lang ? lang : h->frames[w->depth - 1].lang);
    h->b->lang = f->lang;
    if (h->skip || f->act == HTML_SKIP) {
        f->act = HTML_SKIP;
        h->skip++;
    } else if (!strcmp(name, "body")) {
        h->body++;
    } else if (!strcmp(name, "br")) {
        break_line(h);
    } else if (!strcmp(name, "div") || !strcmp(name, "section") || !strcmp(name, "article")) {
        if (!in_note(h) && f->act == HTML_PASS)
            build_end(h->b);
        else
            start_block(h, f, name, attributes);
    } else {
        f->foreign = f->act == HTML_PASS && lang && build_is_open(h->b);
        if (f->foreign)
            build_mark(h->b, MARK_FOREIGN, lang);
        start_block(h, f, name, attributes);
    }
}

static void on_end(struct xml_walk *w, const char *name) {
    struct html *h = w->ctx;
    struct html_frame *f = &h->frames[w->depth];
    if (f->act == HTML_SKIP)
        h->skip--;
    else if (!strcmp(name, "body"))
        build_end(h->b), h->body--;
    else if (f->foreign)
        build_mark_end(h->b, MARK_FOREIGN);
    else if (f->opened && f->act == HTML_MARK)
        build_mark_end(h->b, MARK_EMPHASIS);
    else if (f->opened && f->act == HTML_NOTE)
        build_inset_end(h->b);
    else if (f->opened || (!in_note(h) && (!strcmp(name, "div") || !strcmp(name, "section"))))
        build_end(h->b);
    h->b->lang = h->frames[w->depth - 1].lang;
}

static void on_text(struct xml_walk *w, const char *text, size_t size) {
    struct html *h = w->ctx;
    size_t i = 0;
    if (h->skip || !h->body)
        return;
    while (i < size && strchr(" \t\r\n", text[i]))
        i++;
    if (!build_is_open(h->b) && i < size)
        build_block(h->b, BLOCK_PARAGRAPH);
    build_text(h->b, text, size);
}

/* EPUB 2 takes HTML's names of characters from a DTD that nobody brings along: those of Latin 1 from U+00A0
 * on, and a few others. */
static void on_entity(struct xml_walk *w, const char *name) {
    static const char *const latin[] = {
        "nbsp",   "iexcl",  "cent",   "pound",  "curren", "yen",    "brvbar", "sect",   "uml",    "copy",
        "ordf",   "laquo",  "not",    "shy",    "reg",    "macr",   "deg",    "plusmn", "sup2",   "sup3",
        "acute",  "micro",  "para",   "middot", "cedil",  "sup1",   "ordm",   "raquo",  "frac14", "frac12",
        "frac34", "iquest", "Agrave", "Aacute", "Acirc",  "Atilde", "Auml",   "Aring",  "AElig",  "Ccedil",
        "Egrave", "Eacute", "Ecirc",  "Euml",   "Igrave", "Iacute", "Icirc",  "Iuml",   "ETH",    "Ntilde",
        "Ograve", "Oacute", "Ocirc",  "Otilde", "Ouml",   "times",  "Oslash", "Ugrave", "Uacute", "Ucirc",
        "Uuml",   "Yacute", "THORN",  "szlig",  "agrave", "aacute", "acirc",  "atilde", "auml",   "aring",
        "aelig",  "ccedil", "egrave", "eacute", "ecirc",  "euml",   "igrave", "iacute", "icirc",  "iuml",
        "eth",    "ntilde", "ograve", "oacute", "ocirc",  "otilde", "ouml",   "divide", "oslash", "ugrave",
        "uacute", "ucirc",  "uuml",   "yacute", "thorn",  "yuml"};
    static const struct {
        const char *name;
        uint32_t cp;
    } others[] = {{"ndash", 0x2013}, {"mdash", 0x2014}, {"lsquo", 0x2018}, {"rsquo", 0x2019},
                  {"ldquo", 0x201C}, {"rdquo", 0x201D}, {"bull", 0x2022},  {"hellip", 0x2026},
                  {"euro", 0x20AC},  {"oelig", 0x153},  {"ensp", 0x2002},  {"emsp", 0x2003},
                  {"thinsp", 0x2009}};
    struct html *h = w->ctx;
    uint32_t cp = 0;
    char bytes[4];
    for (size_t i = 0; i < sizeof latin / sizeof *latin; i++)
        if (!strcmp(latin[i], name))
            cp = i ? 0xA0 + (uint32_t)i : ' ';
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (!strcmp(others[i].name, name))
            cp = others[i].cp;
    if (cp)
        on_text(w, bytes, utf8_put(cp, bytes));
    else
        tell(h, w, ERROR_ENTITY, "it is left out, as nobody declares it:", name);
}

int xhtml_read(const char *data, size_t size, const char *name, struct builder *b, struct error *e) {
    struct html *h = mem_alloc(sizeof *h);
    struct xml_walk walk = {.ctx = h, .start = on_start, .end = on_end, .text = on_text, .entity = on_entity};
    h->b = b;
    h->name = name;
    build_section(b, 1);
    int result = xml_walk(&walk, data, size, e);
    while (build_is_open(b))
        build_end(b);
    b->lang = NULL;
    free(h);
    return result;
}
