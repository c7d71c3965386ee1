/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include "server/markup/plain.h"
#include <stdint.h>
#include <string.h>
#include <strings.h>

/* blocks end sentences; lines separate words; inlines are merely known. Their text is spoken, except in
 * silent elements. */
static const char blocks[] = " address article aside blockquote body center dd details dialog div dl dt "
                             "fieldset figcaption figure footer "
                             "form h1 h2 h3 h4 h5 h6 head header hgroup hr html legend li main nav ol p para "
                             "pre s section sent sentence "
                             "speak summary table tbody tfoot thead title tr ul apml jsml emotionml bml fml "
                             "performative turnallocation vsml ";
static const char lines[] = " br td th option break audio img mark wbr input button ";
static const char inlines[] =
    " a abbr acronym b bdi bdo big cite code data del dfn em font i ins kbd label q ruby rt rp samp small "
    "span "
    "strike strong sub sup time tt u var video source picture svg object iframe map area link meta base "
    "say-as sayas phoneme prosody pros voice emphasis emp lang w token desc lexicon lookup metadata ";
static const char silent[] = " script style template noscript ";

static bool is_letter(char c) {
    return (c | 32) >= 'a' && (c | 32) <= 'z';
}

static bool is_name(char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == ':' || c == '.' ||
           (unsigned char)c >= 0x80;
}

static bool listed(const char *list, const char *name, size_t n) {
    for (const char *at = list + 1; *at; at += strcspn(at, " ") + 1)
        if (strcspn(at, " ") == n && !strncasecmp(at, name, n))
            return true;
    return false;
}

bool stray_tag_parts_words(const char *name, size_t n) {
    return listed(blocks, name, n) || listed(lines, name, n);
}

struct stray {
    size_t name, name_bytes; /* offset from "<" */
    size_t length;           /* including ">" */
    bool close, empty, attributes;
};

/* Reads a tag at "<" by its syntax only. Quoted values may contain ">"; a second "<" means that there is
 * no tag. */
static bool read_tag(const char *s, size_t n, struct stray *tag) {
    enum { TAG_BYTES = 1024 };
    size_t at = 1;
    char quote = 0;
    n = n < TAG_BYTES ? n : TAG_BYTES;
    *tag = (struct stray){.close = n > 1 && s[1] == '/'};
    at += tag->close;
    tag->name = at;
    if (at >= n || !(is_letter(s[at]) || (unsigned char)s[at] >= 0x80))
        return false;
    while (at < n && is_name(s[at]))
        at++;
    tag->name_bytes = at - tag->name;
    if (at < n && !is_white(s[at]) && s[at] != '/' && s[at] != '>')
        return false;
    bool spaced = at + 1 < n && is_white(s[at]) && is_letter(s[at + 1]);
    for (; at < n; at++) {
        if (quote) {
            quote = s[at] == quote ? 0 : quote;
        } else if ((s[at] == '"' || s[at] == '\'') && s[at - 1] == '=') {
            quote = s[at];
            tag->attributes = true;
        } else if (s[at] == '<') {
            return false;
        } else if (s[at] == '>') {
            /* "if a<b and c>d": an element of one letter has no attributes without a value */
            if (tag->name_bytes == 1 && spaced && !tag->attributes)
                return false;
            tag->empty = s[at - 1] == '/';
            tag->length = at + 1;
            return true;
        }
    }
    return false;
}

/* Length of an address in angle brackets, as mail and Markdown write it: <https://example.org/a>,
 * <www.example.org>, <anna@example.org>. 0: none. */
static size_t bracketed_address(const char *s, size_t n) {
    enum { ADDRESS_BYTES = 1024 };
    size_t at = 1, scheme = 0, mailbox = 0;
    n = n < ADDRESS_BYTES ? n : ADDRESS_BYTES;
    bool www = n > 5 && !strncasecmp(s + 1, "www.", 4);
    for (; at < n && !is_white(s[at]) && !strchr("<>\"", s[at]); at++) {
        if (!scheme && at > 2 && at + 2 < n && !memcmp(s + at, "://", 3))
            scheme = at;
        else if (!mailbox && at > 1 && s[at] == '@')
            mailbox = at;
    }
    bool address = www || scheme || (mailbox && memchr(s + mailbox, '.', at - mailbox));
    return address && at < n && s[at] == '>' ? at + 1 : 0;
}

/* True if an apparent start tag is one: a known element, with attributes, or closed later. */
static bool is_element(const char *s, size_t n, const struct stray *tag) {
    enum { FAR = 1000 }; /* search limit for the end tag, in bytes: keeps long texts linear */
    const char *name = s + tag->name;
    if (tag->close || tag->empty || tag->attributes || memchr(name, ':', tag->name_bytes) ||
        listed(blocks, name, tag->name_bytes) || listed(lines, name, tag->name_bytes) ||
        listed(inlines, name, tag->name_bytes) || listed(silent, name, tag->name_bytes))
        return true;
    const char *end = s + (n < FAR ? n : FAR), *at = s + tag->length;
    while ((at = memchr(at, '<', (size_t)(end - at)))) {
        at++;
        if ((size_t)(end - at) > tag->name_bytes + 1 && *at == '/' &&
            !strncasecmp(at + 1, name, tag->name_bytes) && !is_name(at[1 + tag->name_bytes]))
            return true;
    }
    return false;
}

/* Remembers failed searches: an end that does not follow one position does not follow a later one, so that
 * each is searched for in vain only once. */
struct ends {
    bool no_comment, no_instruction, no_declaration, no_cdata, no_silent;
};

static size_t past(const char *s, size_t n, const char *end, bool *none) {
    const char *found = *none ? NULL : memmem(s, n, end, strlen(end));
    *none = !found;
    return found ? (size_t)(found - s) + strlen(end) : 0;
}

/* Length up to the end of a silent element's end tag; 0: none. */
static size_t silent_length(const char *s, size_t n, const struct stray *tag, struct ends *ends) {
    for (size_t at = tag->length; !ends->no_silent && at + 2 + tag->name_bytes < n; at++) {
        const char *end = memchr(s + at, '<', n - at);
        if (!end)
            break;
        at = (size_t)(end - s);
        if (at + 2 + tag->name_bytes >= n)
            break;
        if (s[at + 1] == '/' && !strncasecmp(s + at + 2, s + tag->name, tag->name_bytes)) {
            const char *close = memchr(s + at, '>', n - at);
            return close ? (size_t)(close - s) + 1 : 0;
        }
    }
    ends->no_silent = true;
    return 0;
}

static void blank(char *s, size_t n, char with) {
    memset(s, with, n);
}

/* Blanks a comment, declaration or instruction; keeps the text of CDATA. Returns its length; 0: none. */
static size_t blank_other(char *s, size_t n, struct ends *ends) {
    static const char cdata[] = "<![CDATA[";
    size_t length = 0, open = sizeof cdata - 1, end;
    if (n > open && !memcmp(s, cdata, open)) {
        end = past(s, n, "]]>", &ends->no_cdata);
        if (end)
            blank(s + end - 3, 3, MARKDOWN_LEFT_OUT);
        blank(s, open, MARKDOWN_LEFT_OUT);
        return open;
    }
    if (n > 4 && !memcmp(s, "<!--", 4))
        length = past(s, n, "-->", &ends->no_comment);
    else if (n > 2 && s[1] == '?' && is_letter(s[2]))
        length = past(s, n, "?>", &ends->no_instruction);
    else if (n > 2 && s[1] == '!' && is_letter(s[2]))
        length = past(s, n, ">", &ends->no_declaration);
    blank(s, length, ' ');
    return length;
}

/* Returns the number of bytes processed; 0: this is a literal "<". */
static size_t blank_tag(char *s, size_t n, bool *counts, struct ends *ends) {
    struct stray tag;
    size_t other = blank_other(s, n, ends), address = other ? 0 : bracketed_address(s, n);
    if (other)
        return other;
    if (address) {
        s[0] = s[address - 1] = ' ';
        *counts = false;
        return address;
    }
    if (!read_tag(s, n, &tag))
        return 0;
    if (!is_element(s, n, &tag)) { /* a word such as "<Anna>" */
        s[0] = s[tag.length - 1] = ' ';
        *counts = false;
        return tag.length;
    }
    const char *name = s + tag.name;
    size_t whole = !tag.close && !tag.empty && listed(silent, name, tag.name_bytes)
                       ? silent_length(s, n, &tag, ends)
                       : 0;
    bool block = listed(blocks, name, tag.name_bytes), line = listed(lines, name, tag.name_bytes);
    if (whole) {
        blank(s, whole, ' ');
        return whole;
    }
    blank(s, tag.length, block || line || tag.empty ? ' ' : MARKDOWN_LEFT_OUT);
    if (block) /* a blank line ends a sentence; a tag has at least three bytes */
        s[0] = s[1] = '\n';
    return tag.length;
}

static const struct {
    const char *name;
    uint32_t cp;
} references[] = {
    {"amp", '&'},      {"lt", '<'},       {"gt", '>'},        {"quot", '"'},     {"apos", '\''},
    {"nbsp", ' '},     {"shy", 0xAD},     {"hellip", 0x2026}, {"mdash", 0x2014}, {"ndash", 0x2013},
    {"lsquo", 0x2018}, {"rsquo", 0x2019}, {"ldquo", 0x201C},  {"rdquo", 0x201D}, {"bdquo", 0x201E},
    {"laquo", 0xAB},   {"raquo", 0xBB},   {"copy", 0xA9},     {"reg", 0xAE},     {"trade", 0x2122},
    {"deg", 0xB0},     {"euro", 0x20AC},  {"pound", 0xA3},    {"middot", 0xB7},  {"bull", 0x2022},
    {"times", 0xD7},   {"frac12", 0xBD},  {"agrave", 0xE0},   {"aacute", 0xE1},  {"acirc", 0xE2},
    {"atilde", 0xE3},  {"auml", 0xE4},    {"aring", 0xE5},    {"aelig", 0xE6},   {"ccedil", 0xE7},
    {"egrave", 0xE8},  {"eacute", 0xE9},  {"ecirc", 0xEA},    {"euml", 0xEB},    {"igrave", 0xEC},
    {"iacute", 0xED},  {"icirc", 0xEE},   {"iuml", 0xEF},     {"ntilde", 0xF1},  {"ograve", 0xF2},
    {"oacute", 0xF3},  {"ocirc", 0xF4},   {"otilde", 0xF5},   {"ouml", 0xF6},    {"oslash", 0xF8},
    {"ugrave", 0xF9},  {"uacute", 0xFA},  {"ucirc", 0xFB},    {"uuml", 0xFC},    {"szlig", 0xDF},
    {"Agrave", 0xC0},  {"Ccedil", 0xC7},  {"Egrave", 0xC8},   {"Eacute", 0xC9},  {"Ograve", 0xD2},
    {"Ouml", 0xD6},    {"Uuml", 0xDC},    {"Auml", 0xC4},
};

static uint32_t number(const char *s, size_t n) {
    unsigned base = n && (*s | 32) == 'x' ? 16 : 10;
    uint32_t cp = 0;
    s += base == 16;
    n -= base == 16;
    for (size_t i = 0; i < n; i++) {
        char c = s[i] | 32;
        unsigned digit = s[i] >= '0' && s[i] <= '9' ? (unsigned)(s[i] - '0')
                         : c >= 'a' && c <= 'f'     ? (unsigned)(c - 'a' + 10)
                                                    : 99;
        if (digit >= base || cp > 0x10FFFF)
            return 0;
        cp = cp * base + digit;
    }
    return cp;
}

/* Replaces a reference at "&" by its character, which is never longer. Returns the length; 0: not a
 * reference. */
static size_t replace_reference(char *s, size_t n) {
    enum { REFERENCE = 12 };
    const char *end = memchr(s, ';', n < REFERENCE ? n : REFERENCE);
    uint32_t cp = 0;
    if (!end)
        return 0;
    size_t length = (size_t)(end - s) + 1, name = length - 2;
    if (s[1] == '#')
        cp = name > 1 ? number(s + 2, name - 1) : 0;
    for (size_t i = 0; !cp && i < sizeof references / sizeof *references; i++)
        if (strlen(references[i].name) == name && !memcmp(references[i].name, s + 1, name))
            cp = references[i].cp;
    char character[4];
    size_t bytes = cp >= ' ' ? utf8_put(cp, character) : 0;
    if (!bytes || bytes > length)
        return 0;
    memcpy(s, character, bytes);
    blank(s + bytes, length - bytes, MARKDOWN_LEFT_OUT);
    return length;
}

struct stray_tags stray_tags_blank(char *s, size_t n) {
    struct stray_tags found = {0};
    struct ends ends = {0};
    for (size_t at = 0; at < n;) {
        size_t length = 0;
        bool counts = true;
        if (s[at] == '<') {
            length = blank_tag(s + at, n - at, &counts, &ends);
            if (length && counts && !found.count++)
                found.first = at;
        } else if (s[at] == '&') {
            length = replace_reference(s + at, n - at);
        }
        at += length ? length : 1;
    }
    return found;
}
