/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include "server/markup/markup_rules.h"
#include "server/markup/plain.h"
#include <stdint.h>
#include <string.h>

static bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

static bool is_alnum(char c) {
    return (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z') || (unsigned char)c >= 0xC3;
}

/* At the beginning of a line: removes marks of headings, items and quotations. Returns where the text of
 * the line begins. */
static size_t blank_line_mark(char *s, size_t n, size_t at) {
    while (at < n && is_blank(s[at]))
        at++;
    size_t hashes = at;
    while (hashes < n && s[hashes] == '#')
        hashes++;
    bool hashtag = hashes > at && hashes < n && !is_white(s[hashes]); /* "#ciao" is not a heading */
    while (!hashtag && at < n && (s[at] == '#' || s[at] == '>'))
        s[at++] = MARKDOWN_LEFT_OUT;
    if (at + 1 < n && strchr("-*+", s[at]) && is_blank(s[at + 1]))
        s[at++] = MARKDOWN_LEFT_OUT;
    return at;
}

/* Next occurrence of a character, for a scan from beginning to end. It is searched for again only after it
 * has been passed or removed, so that all searches together cost one pass. */
struct next_sign {
    char sign;
    size_t at; /* size of the text = not found */
};

static size_t find_sign(struct next_sign *next, const char *s, size_t n, size_t from) {
    if (next->at < from)
        next->at = from;
    if (next->at < n && s[next->at] != next->sign) {
        const char *at = memchr(s + next->at, next->sign, n - next->at);
        next->at = at ? (size_t)(at - s) : n;
    }
    return next->at;
}

struct link_signs {
    struct next_sign bracket, parenthesis; /* closing ones */
};

/* Reduces [text](address) to its text. */
static void blank_link(struct link_signs *signs, char *s, size_t n, size_t at) {
    size_t close = find_sign(&signs->bracket, s, n, at);
    if (close + 1 >= n || s[close + 1] != '(')
        return;
    size_t end = find_sign(&signs->parenthesis, s, n, close);
    if (end == n)
        return;
    s[at] = MARKDOWN_LEFT_OUT;
    memset(s + close, MARKDOWN_LEFT_OUT, end + 1 - close);
}

/* Offset of the next byte, from `at` on, that may be a mark, a line end or part of an emoji, or n. Several
 * bytes are looked at in one step. */
static size_t next_special(const char *s, size_t n, size_t at) {
    typedef uint8_t bytes __attribute__((vector_size(16)));
    while (at < n) {
        uint8_t c = (uint8_t)s[at];
        if (n - at >= sizeof(bytes)) {
            bytes b;
            uint64_t special[2];
            memcpy(&b, s + at, sizeof b);
            b = (bytes)((b == '\n') | (b == '*') | (b == '[') | (b == '_') | (b == '`') | (b >= 0x7E));
            memcpy(special, &b, sizeof special);
            if (!(special[0] | special[1])) {
                at += sizeof b;
                continue;
            }
        }
        if (c >= 0xC2 && c <= 0xDF && n - at > 1)
            at += 2; /* letters of two bytes */
        else if (c >= 0x7E || c == '\n' || strchr("*[_`", c))
            return at;
        else
            at++;
    }
    return n;
}

/* True if the mark at `s[at]` is markup; in "2 * 3" and "a_name" it is not. */
static bool marks_words(const char *s, size_t n, size_t at) {
    char before = at ? s[at - 1] : ' ', after = at + 1 < n ? s[at + 1] : ' ';
    if (before == MARKDOWN_LEFT_OUT)
        return true;
    if (s[at] == '_')
        return !is_alnum(before) || !is_alnum(after);
    if (s[at] == '*')
        return !(is_white(before) && is_white(after)) &&
               !(before >= '0' && before <= '9' && after >= '0' && after <= '9');
    return s[at] == '`' || (s[at] == '~' && (before == '~' || after == '~'));
}

static size_t sign_said(const struct markup_rules *rules, const char *s, size_t n) {
    return rules->sign_said ? rules->sign_said(rules->sign_lexicons, rules->lang ? rules->lang : "", s, n)
                            : 0;
}

void markdown_blank(char *s, size_t n, bool begins_line, const struct markup_rules *rules) {
    char *whole = s;
    struct link_signs signs = {.bracket.sign = ']', .parenthesis.sign = ')'};
    for (size_t at = 0, length; at < n; at += length) {
        uint32_t cp = 0;
        length = 1;
        if (begins_line)
            at = blank_line_mark(s, n, at);
        at = next_special(s, n, at);
        if (at == n)
            return;
        begins_line = s[at] == '\n';
        if ((unsigned char)s[at] < 0x80) {
            if (s[at] == '[')
                blank_link(&signs, s, n, at);
            else if (strchr("*_`~", s[at]) && marks_words(whole, n, at))
                s[at] = MARKDOWN_LEFT_OUT;
            continue;
        }
        length = utf8_next(s + at, n - at, &cp);
        length = length ? length : 1;
        size_t said = utf8_is_emoji(cp) ? sign_said(rules, s + at, n - at) : 0;
        if (said)
            length = said;
        else if (utf8_is_emoji(cp))
            memset(s + at, MARKDOWN_LEFT_OUT, length);
    }
}

/* True if a line that begins at `at` is marked: a heading, quotation, table or item. */
static bool is_marked_line(const char *s, size_t n, size_t at) {
    while (at < n && is_blank(s[at]))
        at++;
    size_t digits = at;
    while (digits < n && s[digits] >= '0' && s[digits] <= '9')
        digits++;
    if (digits > at)
        return digits < n && strchr(".)", s[digits]);
    return at < n && (strchr("#>|", s[at]) || (strchr("-*+", s[at]) && (at + 1 == n || is_blank(s[at + 1]))));
}

bool markdown_is_needed(const char *s, size_t n) {
    if (is_marked_line(s, n, 0) || memchr(s, MARKDOWN_LEFT_OUT, n))
        return true;
    for (size_t at = 0, length; (at = next_special(s, n, at)) < n; at += length) {
        uint32_t cp = (uint8_t)s[at];
        length = cp < 0x80 ? 1 : utf8_next(s + at, n - at, &cp);
        length = length ? length : 1;
        if (cp == '\n' ? is_marked_line(s, n, at + 1) : cp < 0x7F || utf8_is_emoji(cp))
            return true;
    }
    return false;
}

bool markdown_has_words(const char *s, size_t n) {
    for (size_t at = 0, length; at < n; at += length) {
        uint32_t c;
        length = utf8_next(s + at, n - at, &c);
        if (!length)
            return false;
        bool sign = c < 0xC0 || c == 0xD7 || c == 0xF7 || (c >= 0x2000 && c <= 0x206F) ||
                    (c >= 0x3000 && c <= 0x303F) || c == 0xFE0F || (c >= 0xFF00 && c <= 0xFF0F);
        if (c < 0x80 ? is_alnum((char)c) || (c && strchr("%&+=@$", (int)c)) : !sign)
            return true;
    }
    return false;
}
