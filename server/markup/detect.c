/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/detect.h"
#include "server/base/utf8.h"
#include "server/markup/plain.h"
#include <stdlib.h>
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
    return nul ? error_at_byte(e, ERROR_NUL, (size_t)(nul - text), "the %s contains a NUL character", what)
               : 0;
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
                                 "this is not XML: what begins here does not end");
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

/* Converts the encodings of documents to UTF-8. Tables: ISO/IEC 8859-1 and -9, and Microsoft's code pages
 * 1252 and 1254 according to Unicode's mappings. */

static const uint16_t windows[32] = {
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178,
};

static const struct {
    const char *name;
    bool turkish, windows;
} encodings[] = {
    {"iso-8859-1", false, false},  {"iso8859-1", false, false}, {"iso_8859-1", false, false},
    {"latin1", false, false},      {"latin-1", false, false},   {"l1", false, false},
    {"iso-8859-9", true, false},   {"iso8859-9", true, false},  {"iso_8859-9", true, false},
    {"latin5", true, false},       {"latin-5", true, false},    {"l5", true, false},
    {"windows-1252", false, true}, {"cp1252", false, true},     {"windows-1254", true, true},
    {"cp1254", true, true},
};

/* Returns 0 for a byte without a character. */
static uint32_t decode(uint8_t byte, bool turkish, bool cp) {
    static const uint8_t turkish_bytes[] = {0xD0, 0xDD, 0xDE, 0xF0, 0xFD, 0xFE};
    static const uint16_t turkish_letters[] = {0x011E, 0x0130, 0x015E, 0x011F, 0x0131, 0x015F};
    if (cp && byte >= 0x80 && byte < 0xA0)
        return turkish && (byte == 0x8E || byte == 0x9E) ? 0 : windows[byte - 0x80];
    for (size_t i = 0; turkish && i < sizeof turkish_bytes; i++)
        if (byte == turkish_bytes[i])
            return turkish_letters[i];
    return byte;
}

static int at_byte(struct error *e, enum error_code code, const char *text, size_t byte,
                   const char *message) {
    struct lines lines = {0};
    size_t line, column;
    lines_place(&lines, text, byte, &line, &column);
    return error_at_line(e, code, line, column, "%s", message);
}

int markup_decode(const char *text, size_t size, char **out, size_t *out_size, struct error *e) {
    *out = NULL;
    size_t bad = utf8_check(text, size), known = 0, count = sizeof encodings / sizeof *encodings;
    struct prolog prolog;
    if (bad == size || prolog_read(text, size, &prolog, e) || !*prolog.encoding ||
        !strcmp(prolog.encoding, "utf-8"))
        return 0;
    while (known < count && strcmp(encodings[known].name, prolog.encoding) != 0)
        known++;
    if (known == count)
        return at_byte(e, ERROR_UNKNOWN_ENCODING, text, prolog.encoding_at,
                       "unsupported encoding; UTF-8, ISO-8859-1, ISO-8859-9, windows-1252 and windows-1254 "
                       "are supported");
    struct buf buf = {0};
    for (size_t i = 0; i < size; i++) {
        uint32_t c = decode((uint8_t)text[i], encodings[known].turkish, encodings[known].windows);
        if (!c && text[i]) {
            buf_free(&buf);
            return at_byte(e, ERROR_BAD_ENCODING, text, i, "the stated encoding has no such character");
        }
        buf.size += utf8_put(c, buf_reserve(&buf, 4));
    }
    *out_size = buf.size;
    buf_add(&buf, "", 1);
    *out = (char *)buf.data;
    return 0;
}
