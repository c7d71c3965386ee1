/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A line runs on if it tears a phrase apart: behind an article, preposition, auxiliary or adjective, or
 * before what hangs on its last word. Without a parser, short lists of such words stand for the parts of
 * speech. */
#include "server/base/utf8.h"
#include "server/markup/plain.h"
#include <stdint.h>
#include <string.h>
#include <utf8proc.h>

enum { WORD_BYTES = 64, ENDING_STEM = 2, AGREEING_BYTES = 4 };

static bool is_apostrophe(uint32_t c) {
    return c == '\'' || c == 0x2019 || c == 0x2BC;
}

static bool is_letter(uint32_t c) {
    switch (utf8proc_category((utf8proc_int32_t)c)) {
    case UTF8PROC_CATEGORY_LU:
    case UTF8PROC_CATEGORY_LL:
    case UTF8PROC_CATEGORY_LT:
    case UTF8PROC_CATEGORY_LM:
    case UTF8PROC_CATEGORY_LO:
    case UTF8PROC_CATEGORY_MN: /* of decomposed letters */
        return !is_apostrophe(c);
    default:
        return false;
    }
}

/* Copies a word in lower case, apostrophes as '. Longer words are cut. */
static void copy(const char *text, size_t size, char out[WORD_BYTES]) {
    size_t used = 0, length;
    for (size_t at = 0; at < size && used + 4 < WORD_BYTES; at += length) {
        uint32_t cp;
        length = utf8_next(text + at, size - at, &cp);
        if (!length)
            break;
        used +=
            utf8_put(is_apostrophe(cp) ? '\'' : (uint32_t)utf8proc_tolower((utf8proc_int32_t)cp), out + used);
    }
    out[used] = '\0';
}

/* The last word of a line, with an apostrophe behind it. */
static void last_word(const char *line, size_t size, char out[WORD_BYTES]) {
    size_t from = 0, to = 0, length;
    bool inside = false;
    for (size_t at = 0; at < size; at += length) {
        uint32_t cp;
        length = utf8_next(line + at, size - at, &cp);
        if (!length)
            break;
        bool part = is_letter(cp) || (inside && is_apostrophe(cp));
        from = part && !inside ? at : from;
        to = part ? at + length : to;
        inside = part;
    }
    copy(line + from, to - from, out);
}

/* The first word of a line; "dell'" of "dell'ultimo". */
static void first_word(const char *line, size_t size, char out[WORD_BYTES]) {
    size_t from = SIZE_MAX, to = 0, length;
    for (size_t at = 0; at < size; at += length) {
        uint32_t cp;
        length = utf8_next(line + at, size - at, &cp);
        if (!length || (from != SIZE_MAX && !is_letter(cp) && !is_apostrophe(cp)))
            break;
        if (is_letter(cp) && from == SIZE_MAX)
            from = at;
        to = at + length;
        if (from != SIZE_MAX && is_apostrophe(cp))
            break;
    }
    copy(line + (from == SIZE_MAX ? 0 : from), from == SIZE_MAX ? 0 : to - from, out);
}

/* True if the list has the word with that sign before it ('\0': none). */
static bool listed(const char *const *words, char sign, const char *word) {
    for (; *words; words++) {
        bool own = !strchr(">|~=", **words);
        if (sign ? **words == sign && !strcmp(*words + 1, word) : own && !strcmp(*words, word))
            return true;
    }
    return false;
}

static bool has_listed_ending(const char *const *words, const char *word) {
    size_t length = strlen(word);
    for (; *words; words++) {
        size_t ending = strlen(*words) - 1;
        if (**words == '~' && length >= ending + ENDING_STEM && !strcmp(word + length - ending, *words + 1))
            return true;
    }
    return false;
}

/* True if both words end in the same vowel, or vowel and s: an adjective and its noun may. */
static bool agree(const char *a, const char *b) {
    size_t n = strlen(a), m = strlen(b);
    if (n < AGREEING_BYTES || m < AGREEING_BYTES || a[n - 1] != b[m - 1])
        return false;
    return strchr("aeio", a[n - 1]) || (a[n - 1] == 's' && a[n - 2] == b[m - 2] && strchr("aeo", a[n - 2]));
}

bool verse_asks_for_pause(const char *line, size_t line_size, const char *next, size_t next_size,
                          const char *const *words) {
    char last[WORD_BYTES], first[WORD_BYTES];
    if (!words)
        return true;
    last_word(line, line_size, last);
    first_word(next, next_size, first);
    size_t length = strlen(last);
    if (!length || !*first)
        return true;
    if (last[length - 1] == '\'')
        return false;
    const char *apostrophe = strrchr(last, '\''), *own = apostrophe ? apostrophe + 1 : last;
    if (listed(words, '|', first))
        return true;
    if (listed(words, '\0', own) || listed(words, '>', first))
        return false;
    if (listed(words, '\0', first)) /* starts a new phrase */
        return true;
    return !has_listed_ending(words, last) && !(listed(words, '=', "") && agree(own, first));
}
