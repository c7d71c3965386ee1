/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/plain.h"
#include "server/base/utf8.h"
#include <stdint.h>
#include <string.h>
#include <strings.h>

struct cursor {
    const char *text;
    size_t size, at;
};

/* The character at the cursor (0 at the end) and its length. The text is well-formed UTF-8. */
static uint32_t look(const struct cursor *c, size_t *length) {
    uint32_t cp = 0;
    *length = c->at < c->size ? utf8_next(c->text + c->at, c->size - c->at, &cp) : 0;
    return cp;
}

static bool is_space(uint32_t c) {
    return c == ' ' || (c >= '\t' && c <= '\r') || c == 0xA0 || (c >= 0x2000 && c <= 0x200B) || c == 0x2028 ||
           c == 0x2029 || c == 0x3000 || c == 0xFEFF /* byte order mark */;
}

/* Of Unicode's Sentence_Terminal (UAX 29), those of the scripts that voices here speak. */
static bool is_terminator(uint32_t c) {
    if (c < 0x80)
        return c == '.' || c == '?' || c == '!';
    switch (c) {
    case 0x0589: /* Armenian */
    case 0x061F: /* Arabic question mark */
    case 0x06D4: /* Urdu */
    case 0x0964: /* Devanagari danda */
    case 0x0965:
    case 0x104B: /* Burmese */
    case 0x1362: /* Ethiopic full stop and question mark */
    case 0x1367:
    case 0x2026: /* … */
    case 0x203C: /* ‼ ⁇ ⁈ ⁉ */
    case 0x2047:
    case 0x2048:
    case 0x2049:
    case 0x3002: /* ideographic full stop */
    case 0xFF01:
    case 0xFF1F:
    case 0xFF61:
        return true;
    default:
        return false;
    }
}

static bool is_closing(uint32_t c) {
    return c == '"' || c == '\'' || c == ')' || c == ']' || c == 0xBB || c == 0x2019 || c == 0x201D ||
           c == 0x203A || c == 0x300D /* 」 */ || c == 0x300F || c == 0xFF09;
}

/* Lower-case letters of the Latin scripts that the languages here use. */
static bool is_lower(uint32_t c) {
    if (c < 0x100)
        return (c >= 'a' && c <= 'z') || (c >= 0xDF && c != 0xF7);
    if (c >= 0x139 && c <= 0x148)
        return c % 2 == 0;
    return c <= 0x177 && c % 2 == 1;
}

/* Does the word that ends before `end` stand for more (an initial, "prof")? */
static bool is_abbreviation(const char *text, size_t end, const struct markup_rules *rules) {
    size_t from = end;
    while (from > 0 && !strchr(" \t\r\n(\"'", text[from - 1]))
        from--;
    size_t length = end - from, letter;
    uint32_t cp;
    if (!length)
        return false;
    letter = utf8_next(text + from, length, &cp);
    if (letter == length)
        return !(cp >= '0' && cp <= '9');
    for (const char *const *a = rules ? rules->abbreviations : NULL; a && *a; a++)
        if (strlen(*a) == length && !strncasecmp(*a, text + from, length))
            return true;
    return false;
}

/* At a terminator: the end of the sentence after closing marks, or 0 when it ends none here. */
static size_t sentence_end(struct cursor c, const struct markup_rules *rules) {
    size_t start = c.at, length, marks = 0;
    bool only_dots = true;
    for (uint32_t cp; marks < PLAIN_SENTENCE_BYTES && is_terminator(cp = look(&c, &length));
         c.at += length, marks++)
        only_dots = only_dots && (cp == '.' || cp == 0x2026);
    while (is_closing(look(&c, &length)))
        c.at += length;
    size_t end = c.at;
    if (end == c.size)
        return end;
    uint32_t next = look(&c, &length);
    if (!is_space(next))
        return next >= 0x3000 ? end : 0; /* scripts without spaces */
    while (is_space(next = look(&c, &length)))
        c.at += length;
    if (only_dots && (is_lower(next) || (marks == 1 && is_abbreviation(c.text, start, rules))))
        return 0;
    return end;
}

static size_t skip_space(struct cursor c, bool *blank_line) {
    size_t length, newlines = 0;
    for (uint32_t cp; c.at < c.size && is_space(cp = look(&c, &length)); c.at += length)
        newlines += cp == '\n';
    *blank_line = newlines > 1;
    return c.at;
}

static bool is_letter(char c) {
    return (c | 32) >= 'a' && (c | 32) <= 'z';
}

/* Passes over terminators that end no sentence, as far as one may reach. */
static size_t skip_marks(struct cursor c, size_t next) {
    size_t length;
    for (c.at = next; is_terminator(look(&c, &length)) && c.at + length <= PLAIN_SENTENCE_BYTES;
         c.at += length)
        ;
    return c.at;
}

size_t plain_sentence(const char *text, size_t size, const struct markup_rules *rules) {
    struct cursor c = {text, size, 0};
    size_t comma = 0, space = 0, length;
    size_t enough = rules && rules->sentence_bytes ? rules->sentence_bytes : PLAIN_SENTENCE_BYTES;
    bool blank_line;
    while (c.at < size) {
        while (c.at < PLAIN_SENTENCE_BYTES && c.at + 1 < size && is_letter(text[c.at]))
            c.at++;
        uint32_t cp = look(&c, &length);
        size_t next = c.at + length;
        if (is_terminator(cp)) {
            size_t end = sentence_end(c, rules);
            if (end)
                return skip_space((struct cursor){text, size, end}, &blank_line);
            next = skip_marks(c, next);
        } else if (is_space(cp)) {
            next = skip_space(c, &blank_line);
            if (blank_line)
                return next;
            space = next;
            if (c.at && strchr(",;:", text[c.at - 1]))
                comma = next;
        }
        length = next - c.at;
        c.at = next;
        if (c.at > enough && comma > enough / 4)
            return comma;
        if (c.at > PLAIN_SENTENCE_BYTES)
            return space ? space : c.at - length;
    }
    return size;
}

int plain_read(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
               struct error *e) {
    bool blank_line;
    size_t at = skip_space((struct cursor){text, size, 0}, &blank_line);
    while (at < size) {
        if (markup_given_up(rules))
            return error_set(e, ERROR_CANCELLED, "it was cancelled");
        size_t length = plain_sentence(text + at, size - at, rules), end = at + length;
        while (end > at && strchr(" \t\r\n\v\f", text[end - 1]))
            end--;
        struct score_item *item = score_add(score, SCORE_TEXT, at, end);
        item->text = score_strndup(score, text + at, end - at);
        item->verbatim = true;
        score_end_sentence(score);
        at += length;
    }
    return 0;
}
