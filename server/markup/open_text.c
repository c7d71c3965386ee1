/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/markup/detect.h"
#include "server/markup/markdown.h"
#include "server/markup/open_text_internal.h"
#include "server/markup/plain.h"
#include "server/markup/white.h"
#include <stdlib.h>
#include <string.h>

/* Length without an incomplete character at the end. */
static size_t whole_characters(const char *text, size_t size) {
    size_t back = 0;
    uint32_t cp;
    while (back < 3 && back < size && ((unsigned char)text[size - 1 - back] & 0xC0) == 0x80)
        back++;
    if (back == size || (unsigned char)text[size - 1 - back] < 0xC0)
        return size;
    return utf8_next(text + size - 1 - back, back + 1, &cp) ? size : size - 1 - back;
}

/* Determines the kind from the root element, once its name is complete. Unlike for a complete text, the
 * end of the text plays no role. */
static bool find_kind(struct open_text *o, const char *text, size_t size, enum open_end end) {
    struct prolog prolog;
    struct error e;
    size_t at = 0;
    while (at < size && is_white(text[at]))
        at++;
    if (at == size && end != OPEN_CLOSED)
        return false;
    if (o->kind != markup_by_name("auto"))
        return o->found = true;
    if (at == size || text[at] != '<') {
        o->kind = markup_by_name("plain");
        return o->markdown = o->found = true;
    }
    bool broken = prolog_read(text, size, &prolog, &e);
    size_t root = prolog.root ? (size_t)(prolog.root - text) + prolog.root_bytes : size;
    if (end != OPEN_CLOSED && (broken || root >= size))
        return false;
    o->kind = markup_detect(o->kind, text, root);
    o->markdown = o->kind == markup_by_name("plain");
    return o->found = true;
}

static size_t skip_white(const char *text, size_t size, size_t at, bool *goes_on) {
    for (; at < size && is_white(text[at]); at++)
        *goes_on = *goes_on && text[at] != '\n';
    return at;
}

/* Skips sentences without words. */
static int plain_next(struct open_text *o, const char *text, size_t size, enum open_end end,
                      const struct markup_rules *base, struct open_piece *piece) {
    struct markup_rules rules = *base;
    rules.more = end == OPEN_GOES_ON;
    rules.markdown = o->markdown;
    for (;;) {
        o->at = skip_white(text, size, o->at, &o->goes_on);
        if (o->at == size)
            return 0;
        size_t length = plain_sentence(text + o->at, size - o->at, &rules);
        if (length == PLAIN_UNKNOWN)
            return 0;
        while (is_white(text[o->at + length - 1]))
            length--;
        *piece = (struct open_piece){.start = o->at, .size = length, .length = length};
        piece->text = mem_strndup(text + o->at, length);
        if (rules.markdown)
            markdown_blank(piece->text, length, !o->goes_on, &rules);
        o->at += length;
        o->goes_on = true;
        if (markdown_has_words(piece->text, length))
            return 1;
        free(piece->text);
    }
}

static int no_pieces(const struct open_text *o, struct error *e) {
    return error_in_field(e, ERROR_BAD_FIELD, "markup",
                          "%s is read as a whole: it cannot be written piece by piece", o->kind->name);
}

static bool has_pieces(const struct markup_kind *kind) {
    return kind == markup_by_name("plain") || kind == markup_by_name("ssml") ||
           kind == markup_by_name("apml") || kind == markup_by_name("jsml");
}

int open_text_next(struct open_text *o, const char *text, size_t size, enum open_end end,
                   const struct markup_rules *rules, struct open_piece *piece, struct error *e) {
    size = whole_characters(text, size);
    if (!o->found && !find_kind(o, text, size, end))
        return 0;
    if (!has_pieces(o->kind))
        return no_pieces(o, e);
    if (o->kind == markup_by_name("plain"))
        return plain_next(o, text, size, end, rules, piece);
    return open_xml_next(o, text, size, end, rules, piece, e);
}

bool open_text_seems_ended(const struct open_text *o, const char *text, size_t size,
                           const struct markup_rules *base) {
    struct markup_rules rules = *base;
    size_t whole = whole_characters(text, size);
    if (!o->found || whole != size || o->at >= size)
        return false;
    rules.markdown = o->markdown;
    if (o->kind == markup_by_name("plain"))
        return plain_seems_ended(text + o->at, size - o->at, &rules);
    return open_xml_seems_ended(o, text, size, &rules);
}

/* True for letters, and what separates them in a plain sentence. False for non-ASCII quotes, which may be
 * closed later: U+00AB, U+2018 to U+201F, U+300C and the like. */
static bool is_simple(uint32_t c) {
    if (c < 0x80)
        return (c | 32) >= 'a' ? (c | 32) <= 'z' : strchr(" ,;-'", (int)c) != NULL;
    return (c >= 0xC0 && c < 0x2000) || c == 0x2019;
}

bool open_text_surely_ended(const struct open_text *o, const char *text, size_t size,
                            const struct markup_rules *rules) {
    enum { WORD_LETTERS = 4 };
    size_t letters = 0, words = 0, at = o->at;
    uint32_t c;
    bool lower = false;
    if (!size || !strchr(".?!", text[size - 1]) || o->kind != markup_by_name("plain") ||
        !open_text_seems_ended(o, text, size, rules))
        return false;
    for (; at < size - 1; at += utf8_next(text + at, size - at, &c)) {
        utf8_next(text + at, size - at, &c);
        if (!is_simple(c))
            return false;
        bool letter = c >= 0x80 || c >= 'A';
        if (letter && !letters)
            lower = (c >= 'a' && c <= 'z') || c >= 0xDF;
        words += letter && !letters;
        letters = letter ? letters + 1 : 0;
    }
    return words > 1 && letters >= WORD_LETTERS && lower;
}

size_t open_piece_byte(const struct open_piece *p, size_t byte) {
    size_t in = byte > p->lead ? byte - p->lead : 0;
    return p->start + (in < p->length ? in : p->length);
}

void open_piece_place(const struct open_piece *p, const char *text, struct error *e) {
    struct lines in = {0}, of = {0};
    size_t line = 1, column = 1, byte = 0;
    if (e->place != PLACE_LINE)
        return;
    while (byte < p->size && (line < e->line || (line == e->line && column < e->column)))
        lines_place(&in, p->text, ++byte, &line, &column);
    lines_place(&of, text, open_piece_byte(p, byte), &e->line, &e->column);
}

void open_text_free(struct open_text *o) {
    free(o->elements);
    *o = (struct open_text){0};
}
