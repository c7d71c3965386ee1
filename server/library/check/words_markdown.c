/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scans Markdown for its words: drops signs, addresses, tags and comments, without parsing its blocks as
 * cmark does. */
#include "server/base/buf.h"
#include "server/library/check/words_source.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static size_t line_size(const char *text, size_t size) {
    const char *newline = memchr(text, '\n', size);
    return newline ? (size_t)(newline - text) + 1 : size;
}

/* Length of the sign of a quotation, list item or task at the beginning of a line. within: of a paragraph,
 * which only a list from 1 on interrupts. */
static size_t list_sign(const char *line, size_t size, bool within) {
    size_t at = 0, sign = 0;
    while (at < size && strchr(" \t>", line[at]))
        at++;
    size_t digits = strspn(line + at, "0123456789");
    if (within && (digits != 1 || line[at] != '1'))
        digits = 0;
    if (digits && digits < 10 && at + digits + 1 < size && strchr(".)", line[at + digits]) &&
        strchr(" \t\r\n", line[at + digits + 1]))
        sign = at += digits + 1;
    else if (at + 1 < size && strchr("-+*", line[at]) && strchr(" \t", line[at + 1]))
        sign = at += 1;
    while (sign && at < size && line[at] == ' ')
        at++;
    if (sign && size - at > 3 && line[at] == '[' && strchr(" xX", line[at + 1]) && line[at + 2] == ']')
        sign = at + 3;
    return sign;
}

/* Position after the bracket that closes the one at text[at], on the same paragraph; `at`: none. */
static size_t after_bracket(const char *text, size_t size, size_t at, char close) {
    unsigned depth = 0;
    char open = text[at];
    for (size_t i = at; i < size; i++) {
        if (text[i] == '\\')
            i++;
        else if (text[i] == '\n' && i + 1 < size && text[i + 1] == '\n')
            break;
        else if (text[i] == open)
            depth++;
        else if (text[i] == close && !--depth)
            return i + 1;
    }
    return at;
}

/* Adds one paragraph's worth of text without its signs. */
static void add_marked(struct collector *c, const char *text, size_t size) {
    bool code = false;
    for (size_t at = 0; at < size;) {
        char sign = text[at];
        size_t to = at;
        const char *comment = !code && size - at > 4 && !memcmp(text + at, "<!--", 4)
                                  ? memmem(text + at, size - at, "-->", 3)
                                  : NULL;
        if (comment) {
            at = (size_t)(comment - text) + 3;
        } else if (sign == '`') {
            code = !code;
            at += strspn(text + at, "`");
        } else if (!code && sign == '\\' && at + 1 < size) {
            bool escapes = ispunct((unsigned char)text[at + 1]);
            if (text[at + 1] == '*' || !escapes)
                collector_end_word(c);
            else
                collector_add(c, text + at + 1, 1);
            at += escapes ? 2 : 1;
        } else if (!code && sign == '<' && (to = after_bracket(text, size, at, '>')) > at + 2 &&
                   !memchr(text + at, ' ', 2)) {
            bool address = (memchr(text + at, ':', to - at) || memchr(text + at, '@', to - at)) &&
                           !memchr(text + at, '"', to - at) && !memchr(text + at, ' ', to - at);
            if (address)
                collector_add(c, text + at, to - at);
            else if (!strncmp(text + at, "<br", 3))
                collector_end_word(c);
            at = to;
        } else if (!code && sign == ']' && at + 1 < size && text[at + 1] == '(' &&
                   (to = after_bracket(text, size, at + 1, ')')) > at + 1) {
            at = to;
        } else if (!code && sign == ']' && at + 1 < size && text[at + 1] == '[' &&
                   (to = after_bracket(text, size, at + 1, ']')) > at + 1) {
            at = to;
        } else if (!code && sign == '[' && at + 1 < size && text[at + 1] == '^' &&
                   (to = after_bracket(text, size, at, ']')) > at) {
            at = to;
        } else if (!code && (sign == '*' || (sign == '~' && at + 1 < size && text[at + 1] == '~'))) {
            at += strspn(text + at, sign == '*' ? "*" : "~");
        } else if (!code && sign == '&') {
            const char *end = memchr(text + at, ';', size - at < 34 ? size - at : 34);
            to = end ? (size_t)(end - text) + 1 : at + 1;
            collector_references(c, text + at, to - at);
            at = to;
        } else {
            do
                to++;
            while (to < size && !strchr("`\\<][*~&", text[to]));
            collector_add(c, text + at, to - at);
            at = to;
        }
    }
}

/* True for "[name]: address", which only names a link's target. */
static bool is_definition(const char *line, size_t size) {
    size_t at = strspn(line, " ");
    size_t close = at < 4 && at + 1 < size && line[at] == '[' && line[at + 1] != '^'
                       ? after_bracket(line, size, at, ']')
                       : at;
    return close > at && close < size && line[close] == ':';
}

void words_markdown_read(struct collector *c, const char *text, size_t size) {
    size_t line = 0;
    uint32_t number = c->line, begin = number;
    struct buf plain = {0};
    bool fenced = false, comment = false, indented, list = false;
    for (size_t at = 0; at <= size; at += line, number++) {
        line = at < size ? line_size(text + at, size - at) : 1;
        size_t blank = at < size ? strspn(text + at, " \t>") : 0;
        bool fence =
            at < size && (!strncmp(text + at + blank, "```", 3) || !strncmp(text + at + blank, "~~~", 3));
        bool ends = at >= size || blank >= line || strchr("\r\n", text[at + blank]);
        /* inside a paragraph, add_marked drops comments */
        const char *opening = at < size && !fenced && !plain.size && !strncmp(text + at + blank, "<!--", 4)
                                  ? text + at + blank
                                  : NULL;
        if (comment || (opening && !memmem(opening, (size_t)(text + at + line - opening), "-->", 3))) {
            comment = at < size && (!comment || !memmem(text + at, line, "-->", 3));
            continue;
        }
        indented = at < size && !plain.size && !list && (text[at] == '\t' || !strncmp(text + at, "    ", 4));
        if (!ends && !indented && at < size && !strchr(" \t", text[at]))
            list = list_sign(text + at, line, plain.size > 0 && !list) > 0;
        if ((fenced && !fence && at < size) || (indented && !ends && !fence)) {
            c->line = number;
            collector_add(c, text + at, line);
        } else if (ends || fence) {
            if (plain.size) {
                buf_add(&plain, "\n", 1);
                buf_add(&plain, "", 1);
                c->line = begin;
                add_marked(c, (const char *)plain.data, plain.size - 1);
            }
            collector_end_word(c);
            buf_free(&plain);
            if (fence)
                fenced = !fenced;
        } else if (!is_definition(text + at, line)) {
            size_t sign = list_sign(text + at, line, plain.size > 0 && !list);
            begin = plain.size ? begin : number;
            if (sign && plain.size)
                buf_add(&plain, " . ", 3);
            buf_add(&plain, text + at + sign, line - sign);
        }
    }
}
