/* SPDX-License-Identifier: GPL-3.0-or-later */
/* XHTML documents of an EPUB. */
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <utf8proc.h>

enum html_act {
    HTML_PASS,
    HTML_SKIP,
    HTML_GROUP, /* ends the current block at its start and its end */
    HTML_HEAD,
    HTML_PARAGRAPH,
    HTML_ITEM,
    HTML_ROW, /* of a table */
    HTML_CELL,
    HTML_NOTE,
    HTML_NOTES, /* a list of notes */
    HTML_LINE,  /* a line of verse */
    HTML_SPEAKER,
    HTML_DIRECTION, /* a stage direction of its own */
    HTML_MARK,
    HTML_PAGE,
    HTML_STAGE, /* a stage direction within a block */
    HTML_BREAK,
    HTML_LINK,
    HTML_ALTERNATIVE, /* a picture or a formula, replaced by its author's text */
    HTML_SUPERSCRIPT,
    HTML_QUOTE,
};

struct html_frame {
    enum html_act act;
    bool begun;                 /* CELL: it has had a paragraph */
    bool opened, foreign, sign; /* sign: a link that may be a note's sign */
    size_t from;                /* LINK: size of the block's text at its start */
    char lang[36];
};

struct html {
    struct html_frame frames[WORK_DEPTH_MAX + 1];
    struct builder *b;
    const char *name;
    struct quotes quotes;
    unsigned skip, body, notes, superscripts, svg; /* numbers of open elements */
};

/* Reports a problem with its line and the file in the archive. */
static void tell(struct html *h, const struct xml_walk *w, enum error_code code, const char *what,
                 const char *which) {
    struct error e;
    error_at_line(&e, code, xml_walk_line(w), xml_walk_column(w), "%.120s: %s %.60s", h->name, what, which);
    build_problem(h->b, &e, false);
}

/* Looks in epub:type and role: "footnote" is "doc-footnote" as a role. */
static bool has_type(const char **attributes, const char *word) {
    char role[32];
    snprintf(role, sizeof role, "doc-%s", word);
    return xml_has_token(attributes, "type", word) || xml_has_token(attributes, "role", role);
}

/* True when a style contains "property: value". */
static bool has_style(const char *style, const char *property, const char *value) {
    for (const char *at = style; (at = strstr(at, property)); at++) {
        const char *end = at + strlen(property);
        bool begins = at == style || strchr("; \t\r\n", at[-1]);
        end += strspn(end, " \t\r\n");
        if (!begins || *end != ':')
            continue;
        end += 1 + strspn(end + 1, " \t\r\n");
        if (!strncmp(end, value, strlen(value)))
            return true;
    }
    return false;
}

/* True for content hidden from readers and from assistive technology. */
static bool is_hidden(const char **attributes) {
    const char *hidden = xml_attribute(attributes, "hidden"),
               *aria = xml_attribute(attributes, "aria-hidden"), *style = xml_attribute(attributes, "style");
    return hidden || (aria && !strcmp(aria, "true")) ||
           (style && (has_style(style, "display", "none") || has_style(style, "visibility", "hidden")));
}

static const char *alternative_of(const char *name, const char **attributes) {
    const char *text = xml_attribute(attributes, !strcmp(name, "math") ? "alttext" : "alt");
    return text ? text : xml_attribute(attributes, "aria-label");
}

static enum html_act act_of(const struct html *h, const char *name, const char **attributes) {
    static const char *const skipped[] = {
        "head",       "script",         "style",    "nav", "audio", "video",    "iframe",
        "button",     "input",          "rt",       "rp",  "rtc",   "template", "datalist",
        "annotation", "annotation-xml", "metadata", NULL};
    static const char *const blocks[] = {"p",       "pre",     "figcaption", "dd",     "dt",
                                         "caption", "address", "summary",    "legend", NULL};
    static const char *const groups[] = {
        "div", "section", "article", "main",    "header", "footer",     "aside", "figure",   "ul", "ol",
        "dl",  "table",   "hr",      "details", "center", "blockquote", "form",  "fieldset", NULL};
    static const char *const marks[] = {"em", "i", "b", "strong", "cite", "dfn", "u", NULL};
    static const char *const holders[] = {"td", "th", "dt", "p", "div", "li", "span", NULL};
    static const char *const notes[] = {"footnote", "endnote", "rearnote", NULL};
    static const char *const lists[] = {"footnotes", "endnotes", "rearnotes", NULL};
    if (xml_is_one(name, skipped) || is_hidden(attributes))
        return HTML_SKIP;
    if (h->svg && (!strcmp(name, "title") || !strcmp(name, "desc") || !strcmp(name, "defs")))
        return HTML_SKIP;
    if (has_type(attributes, "pagebreak"))
        return HTML_PAGE;
    if (has_type(attributes, "noteref") || has_type(attributes, "backlink") ||
        has_type(attributes, "referrer"))
        return HTML_SKIP;
    for (size_t i = 0; notes[i] && strcmp(name, "a") != 0; i++) {
        if (has_type(attributes, notes[i]) && strcmp(name, "body") != 0)
            return HTML_NOTE;
        if (has_type(attributes, lists[i]))
            return HTML_NOTES;
    }
    if (xml_is_one(name, holders) && xml_has_token(attributes, "type", "persona"))
        return HTML_SPEAKER;
    if (xml_is_one(name, holders) && xml_has_token(attributes, "class", "line"))
        return HTML_LINE;
    if (xml_has_token(attributes, "type", "stage-direction") && (!strcmp(name, "p") || !strcmp(name, "div")))
        return HTML_DIRECTION;
    if (xml_has_token(attributes, "type", "stage-direction") &&
        (xml_is_one(name, marks) || !strcmp(name, "span")))
        return HTML_STAGE;
    if (name[0] == 'h' && name[1] >= '1' && name[1] <= '6' && !name[2])
        return HTML_HEAD;
    if (h->notes && (!strcmp(name, "li") || !strcmp(name, "p") || !strcmp(name, "dd")))
        return HTML_NOTE;
    if (xml_is_one(name, blocks))
        return HTML_PARAGRAPH;
    if (xml_is_one(name, groups))
        return HTML_GROUP;
    if (!strcmp(name, "img") || (!strcmp(name, "math") && alternative_of(name, attributes)))
        return HTML_ALTERNATIVE;
    return !strcmp(name, "li")               ? HTML_ITEM
           : !strcmp(name, "br")             ? HTML_BREAK
           : !strcmp(name, "a")              ? HTML_LINK
           : !strcmp(name, "sup")            ? HTML_SUPERSCRIPT
           : !strcmp(name, "tr")             ? HTML_ROW
           : !strcmp(name, "td")             ? HTML_CELL
           : !strcmp(name, "th")             ? HTML_CELL
           : !strcmp(name, "q")              ? HTML_QUOTE
           : h->svg && !strcmp(name, "text") ? HTML_PARAGRAPH
           : xml_is_one(name, marks)         ? HTML_MARK
                                             : HTML_PASS;
}

static bool in_note(const struct html *h) {
    return build_is_open(h->b) && build_kind(h->b) == BLOCK_NOTE;
}

/* Turns the paragraph into verse, one line per break. */
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

static void add_text(struct html *h, const char *text, size_t size) {
    size_t i = 0;
    while (i < size && strchr(" \t\r\n", text[i]))
        i++;
    if (!build_is_open(h->b) && i < size)
        build_block(h->b, BLOCK_PARAGRAPH);
    size_t done = h->quotes.depth ? quotes_text(&h->quotes, h->b, text, size) : 0;
    build_text(h->b, text + done, size - done);
}

static void start_note(struct html *h, struct html_frame *f) {
    while (build_is_open(h->b))
        build_end(h->b);
    build_inset(h->b, BLOCK_NOTE, NULL);
    f->opened = true;
}

/* True for a link within the book to a note: raised, in brackets, or by the target's name. */
static bool leads_to_note(const struct html *h, const char **attributes) {
    static const char *const names[] = {"note", "fn", "ftn", "endn", "footn", NULL};
    const char *href = xml_attribute(attributes, "href"), *part = href ? strchr(href, '#') : NULL;
    bool named = false;
    for (size_t i = 0; part && names[i]; i++)
        named = named || !strncasecmp(part + 1, names[i], strlen(names[i]));
    return part && part[1] && (named || h->superscripts);
}

static void start_inline(struct html *h, struct html_frame *f, const char *name, const char **attributes) {
    static const char *const words[] = {"mi", "mn", "mo", "mtext", "tspan", NULL};
    const char *text;
    switch (f->act) {
    case HTML_MARK:
        f->opened = build_is_open(h->b);
        if (f->opened)
            build_mark(h->b, MARK_EMPHASIS, NULL);
        break;
    case HTML_STAGE:
        f->opened = build_is_open(h->b) && build_kind(h->b) != BLOCK_STAGE;
        if (f->opened)
            build_mark(h->b, MARK_STAGE, NULL);
        break;
    case HTML_BREAK:
        break_line(h);
        break;
    case HTML_QUOTE:
        quotes_begin(&h->quotes, h->b, (f - 1)->lang);
        break;
    case HTML_SUPERSCRIPT:
        h->superscripts++;
        (f - 1)->sign = (f - 1)->sign || (f - 1)->act == HTML_LINK;
        break;
    case HTML_LINK:
        f->sign = build_is_open(h->b) && leads_to_note(h, attributes);
        f->opened = build_is_open(h->b) && xml_attribute(attributes, "href");
        f->from = build_is_open(h->b) ? build_top(h->b)->text.size : 0;
        break;
    case HTML_ALTERNATIVE:
        text = alternative_of(name, attributes);
        build_apart(h->b);
        if (text && h->body)
            add_text(h, text, strlen(text));
        build_apart(h->b);
        f->act = HTML_SKIP;
        h->skip++;
        break;
    default:
        if (xml_is_one(name, words))
            build_apart(h->b);
    }
}

static void end_speech(struct html *h) {
    build_speaker(h->b, NULL);
    build_who(h->b, NULL);
}

static void start_block(struct html *h, struct html_frame *f, const char *name, const char **attributes) {
    struct builder *b = h->b;
    const char *label = xml_attribute(attributes, "title");
    struct block *top = build_top(b);
    if (f->act == HTML_PAGE) {
        build_page(b, label ? label : xml_attribute(attributes, "aria-label"));
        f->act = HTML_SKIP;
        h->skip++;
    } else if (f->act == HTML_NOTES) {
        while (build_is_open(b))
            build_end(b);
        h->notes++;
    } else if (in_note(h)) {
        build_newline(b);
    } else if (f->act == HTML_GROUP) {
        build_end(b);
        f->opened = true;
    } else if (f->act == HTML_DIRECTION) {
        build_block(b, BLOCK_STAGE);
        f->opened = true;
    } else if (f->act == HTML_HEAD) {
        end_speech(h);
        unsigned level = (unsigned)(name[1] - '0');
        if (level <= 3 && b->section.count)
            build_section(b, level);
        build_block(b, BLOCK_HEAD);
        build_top(b)->level = level;
        f->opened = true;
    } else if (f->act == HTML_SPEAKER) {
        build_who(b, xml_attribute(attributes, "data-who"));
        build_block(b, BLOCK_SPEAKER);
        f->opened = true;
    } else if (f->act == HTML_LINE) {
        build_line(b, NULL, false);
        f->opened = true;
        if (*f->lang && strcmp(f->lang, build_top(b)->lang ? build_top(b)->lang : "") != 0) {
            build_mark(b, MARK_FOREIGN, f->lang);
            f->foreign = true;
        }
    } else if (f->act == HTML_PARAGRAPH && (f - 1)->act == HTML_CELL && !(f - 1)->opened && !(f - 1)->begun &&
               top) {
        (f - 1)->begun = true;
    } else if (f->act == HTML_PARAGRAPH && top && top->item && !top->text.size) {
        f->opened = true; /* the item has no text before it */
    } else if (f->act == HTML_CELL && top && top->item && (f - 1)->act == HTML_ROW) {
        build_join_cells(b);
    } else if (f->act == HTML_PARAGRAPH || f->act == HTML_ITEM || f->act == HTML_ROW || f->act == HTML_CELL) {
        build_block(b, BLOCK_PARAGRAPH);
        build_top(b)->item = f->act == HTML_ITEM || f->act == HTML_ROW;
        f->opened = true;
    } else {
        start_note(h, f);
    }
}

static bool is_block(enum html_act act) {
    return act >= HTML_GROUP && act != HTML_MARK && act <= HTML_PAGE;
}

static void tell_lang(struct html *h, const struct xml_walk *w, const char *lang) {
    struct error e;
    error_at_line(&e, ERROR_BAD_VALUE, xml_walk_line(w), xml_walk_column(w),
                  "\"%.40s\" is not a language tag (BCP 47, such as pt-BR)", lang);
    build_problem(h->b, &e, false);
}

static void on_start(struct xml_walk *w, const char *name, const char **attributes) {
    struct html *h = w->ctx;
    struct html_frame *f = &h->frames[w->depth];
    const char *lang = xml_attribute(attributes, "lang");
    char tag[LANG_BYTES + 1];
    size_t bad;
    if (lang && *lang) { /* an invalid tag is ignored */
        bool known = lang_read(lang, strlen(lang), tag, &bad);
        if (!known)
            tell_lang(h, w, lang);
        lang = known ? tag : NULL;
    }
    *f = (struct html_frame){.act = act_of(h, name, attributes)};
    snprintf(f->lang, sizeof f->lang, "%s", lang ? lang : (f - 1)->lang);
    h->b->lang = f->lang;
    if (h->skip || f->act == HTML_SKIP) {
        f->act = HTML_SKIP;
        h->skip++;
        return;
    }
    bool svg = !strcmp(name, "svg");
    if (!strcmp(name, "body") || (svg && w->depth == 1))
        h->body++;
    h->svg += svg;
    if (is_block(f->act)) {
        start_block(h, f, name, attributes);
        return;
    }
    if (lang && build_is_open(h->b) && strcmp(lang, (f - 1)->lang) != 0) {
        build_mark(h->b, MARK_FOREIGN, lang);
        f->foreign = true;
    }
    start_inline(h, f, name, attributes);
}

/* True for text without letters: digits, asterisks, arrows, brackets. */
static bool is_sign(const struct block *block, size_t from, bool *brackets) {
    const char *text = (const char *)block->text.data + from;
    size_t size = block->text.size - from, letters = 0, length;
    *brackets = false;
    for (size_t at = 0; at < size; at += length) {
        uint32_t cp;
        length = utf8_next(text + at, size - at, &cp);
        length = length ? length : 1;
        int category = utf8proc_category((utf8proc_int32_t)cp);
        letters += category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_LO;
        *brackets = *brackets || cp == '[' || cp == '*' || cp == '^' || (cp >= 0x2020 && cp <= 0x2021) ||
                    (cp >= 0x2190 && cp <= 0x21FF);
    }
    *brackets = *brackets && !letters;
    return size && size <= 12 && letters <= 1;
}

static void end_link(struct html *h, const struct html_frame *f) {
    const struct block *block = build_top(h->b);
    bool brackets;
    if (f->opened && block && block->text.size > f->from && is_sign(block, f->from, &brackets) &&
        (f->sign || brackets)) {
        build_cut(h->b, f->from);
        build_apart(h->b);
    }
}

static void end_speaker(struct html *h) {
    const struct block *block = build_top(h->b);
    char *who = block && block->kind == BLOCK_SPEAKER
                    ? mem_strndup(block->text.size ? (char *)block->text.data : "", block->text.size)
                    : NULL;
    build_end(h->b);
    build_speaker(h->b, who);
    free(who);
}

static void on_end(struct xml_walk *w, const char *name) {
    struct html *h = w->ctx;
    struct html_frame *f = &h->frames[w->depth];
    bool svg = f->act != HTML_SKIP && !strcmp(name, "svg");
    if (f->act == HTML_QUOTE)
        quotes_end(&h->quotes, h->b);
    if (f->foreign)
        build_mark_end(h->b, MARK_FOREIGN);
    if (f->act == HTML_SKIP)
        h->skip--;
    else if (f->act == HTML_LINK)
        end_link(h, f);
    else if (f->act == HTML_SUPERSCRIPT)
        h->superscripts--;
    else if (f->act == HTML_NOTES)
        h->notes--;
    else if (f->opened && f->act == HTML_MARK)
        build_mark_end(h->b, MARK_EMPHASIS);
    else if (f->opened && f->act == HTML_STAGE)
        build_mark_end(h->b, MARK_STAGE);
    else if (f->opened && f->act == HTML_LINE)
        build_line_end(h->b);
    else if (f->opened && f->act == HTML_SPEAKER)
        end_speaker(h);
    else if (f->opened && f->act == HTML_NOTE)
        build_inset_end(h->b);
    else if (f->opened || !strcmp(name, "body"))
        build_end(h->b);
    if (!strcmp(name, "tr") || !strcmp(name, "body"))
        end_speech(h); /* a row of a play is one speech */
    if (!strcmp(name, "body") || (svg && w->depth == 1))
        h->body--;
    h->svg -= svg;
    h->b->lang = (f - 1)->lang;
}

static void on_text(struct xml_walk *w, const char *text, size_t size) {
    struct html *h = w->ctx;
    if (!h->skip && h->body)
        add_text(h, text, size);
}

/* EPUB 2 takes HTML's entities from a DTD that is not available. */
static void on_entity(struct xml_walk *w, const char *name) {
    struct html *h = w->ctx;
    char text[ENTITY_BYTES_MAX];
    size_t size = xml_entity(name, text);
    if (size)
        on_text(w, text, size);
    else
        tell(h, w, ERROR_ENTITY, "it is dropped because it is not declared:", name);
}

int xhtml_read(const char *data, size_t size, const char *name, struct builder *b, struct error *e) {
    struct html *h = mem_alloc(sizeof *h);
    struct xml_walk walk = {.ctx = h,
                            .start = on_start,
                            .end = on_end,
                            .text = on_text,
                            .entity = on_entity,
                            .stop = &b->stopped};
    b->where = xml_walk_where;
    b->where_ctx = &walk;
    h->b = b;
    h->name = name;
    build_section(b, 1);
    int result = xml_walk(&walk, data, size, e);
    while (build_is_open(b))
        build_end(b);
    b->lang = NULL;
    b->where = NULL;
    free(h);
    return result;
}
