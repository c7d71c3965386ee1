/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/detect.h"
#include "server/base/utf8.h"
#include "server/markup/white.h"
#include <string.h>
#include <strings.h>

struct scan {
    const char *text;
    size_t size, at;
};

static bool begins(const struct scan *s, const char *with) {
    size_t n = strlen(with);
    return s->size - s->at >= n && !memcmp(s->text + s->at, with, n);
}

static void skip_white(struct scan *s) {
    while (s->at < s->size && is_white(s->text[s->at]))
        s->at++;
}

/* Moves past the next `end`. False if there is none. */
static bool skip_past(struct scan *s, const char *end) {
    const char *found = memmem(s->text + s->at, s->size - s->at, end, strlen(end));
    if (found)
        s->at = (size_t)(found - s->text) + strlen(end);
    return found;
}

/* Moves from "<!DOCTYPE" past its ">", skipping quoted strings, comments and nested declarations, which
 * may contain one. */
static bool skip_doctype(struct scan *s, struct prolog *prolog) {
    bool inside = false;
    for (s->at += 2; s->at < s->size; s->at++) {
        char c = s->text[s->at];
        if (begins(s, "<!--")) {
            s->at += 4;
            if (!skip_past(s, "-->"))
                return false;
            s->at--;
        } else if (begins(s, "<?")) {
            if (!skip_past(s, "?>"))
                return false;
            s->at--;
        } else if (c == '"' || c == '\'') {
            const char *close = memchr(s->text + s->at + 1, c, s->size - s->at - 1);
            if (!close)
                return false;
            s->at = (size_t)(close - s->text);
        } else if (c == '[') {
            inside = true;
        } else if (c == ']') {
            inside = false;
        } else if (c == '>' && !inside) {
            s->at++;
            return true;
        } else if (begins(s, "<!ENTITY") && !prolog->entities) {
            prolog->entities = s->at;
        }
    }
    return false;
}

/* Reads the value of encoding="..." from the XML declaration text[from..). */
static void read_encoding(const struct scan *s, size_t from, struct prolog *prolog) {
    const char *at = memmem(s->text + from, s->at - from, "encoding", 8), *end = s->text + s->at;
    if (!at)
        return;
    for (at += 8; at < end && (is_white(*at) || *at == '='); at++)
        ;
    if (at == end || (*at != '"' && *at != '\''))
        return;
    char quote = *at++;
    prolog->encoding_at = (size_t)(at - s->text);
    for (size_t n = 0; at < end && *at != quote && n < sizeof prolog->encoding - 1; at++)
        prolog->encoding[n++] = *at >= 'A' && *at <= 'Z' ? (char)(*at | 32) : *at;
}

static bool is_name(char c) {
    return c && !strchr(" \t\r\n/><='\"&;?!", c);
}

int text_check(const char *text, size_t size, const char *what, struct error *e) {
    size_t bad = utf8_check(text, size);
    if (bad < size)
        return error_at_byte(e, ERROR_BAD_UTF8, bad, "the %s is not UTF-8", what);
    const char *nul = memchr(text, '\0', size);
    return nul ? error_at_byte(e, ERROR_NUL, (size_t)(nul - text), "the %s holds a NUL character", what) : 0;
}

int prolog_read(const char *text, size_t size, struct prolog *prolog, struct error *e) {
    struct scan s = {text, size, 0};
    *prolog = (struct prolog){0};
    if (begins(&s, "\xEF\xBB\xBF"))
        s.at = 3;
    size_t item = s.at;
    for (bool well = true; well;) {
        skip_white(&s);
        item = s.at;
        if (begins(&s, "<?")) {
            s.at += 2;
            well = skip_past(&s, "?>");
            if (!memcmp(text + item, "<?xml", s.size - item > 5 ? 5 : s.size - item))
                prolog->declared = true;
            if (well && prolog->declared && s.at - item > 7 && is_white(text[item + 5]))
                read_encoding(&s, item, prolog);
            else if (!prolog->instruction)
                prolog->instruction = item;
        } else if (begins(&s, "<!--")) {
            s.at += 4;
            well = skip_past(&s, "-->");
        } else if (begins(&s, "<!DOCTYPE") || begins(&s, "<!doctype")) {
            prolog->declared = true;
            well = skip_doctype(&s, prolog);
        } else {
            break;
        }
        if (!well) {
            struct lines lines = {0};
            size_t line, column;
            lines_place(&lines, text, item, &line, &column);
            return error_at_line(e, ERROR_BAD_XML, line, column,
                                 "this is no XML: what begins here does not end");
        }
    }
    prolog->end = s.at;
    if (s.at < size && text[s.at] == '<') {
        prolog->root = text + ++s.at;
        while (s.at < size && is_name(text[s.at]))
            s.at++;
        prolog->root_bytes = (size_t)(text + s.at - prolog->root);
    }
    return 0;
}

bool prolog_root_is(const struct prolog *prolog, const char *name) {
    const char *root = prolog->root;
    size_t bytes = prolog->root_bytes, length = strlen(name);
    const char *colon = root ? memchr(root, ':', bytes) : NULL;
    if (colon) {
        bytes -= (size_t)(colon + 1 - root);
        root = colon + 1;
    }
    return root && bytes == length && !strncasecmp(root, name, length);
}
