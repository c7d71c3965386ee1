/* SPDX-License-Identifier: GPL-3.0-or-later */
/* UTF-8 (RFC 3629): no overlong forms, no surrogates, nothing above U+10FFFF. */
#ifndef FACCIA_BASE_UTF8_H
#define FACCIA_BASE_UTF8_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Decodes the character at s (n > 0 bytes). Returns its length, 1 to 4, and its code point; 0 if
 * malformed. */
size_t utf8_next(const char *s, size_t n, uint32_t *cp);

/* True for emoji, their joiners, skin tones and flags. */
bool utf8_is_emoji(uint32_t cp);

/* Writes cp to out (4 bytes) and returns the length; 0 if cp is not a character. */
size_t utf8_put(uint32_t cp, char *out);

/* Returns the offset of the first malformed byte, or n. */
size_t utf8_check(const char *s, size_t n);

/* Likewise for text in pieces. Begins zeroed. Returns the offset in the piece of the byte that makes a
 * character malformed (the character began `done` bytes before it), or n. If `need` is not 0 at the end of
 * the text, the last character is incomplete. */
struct utf8_reader {
    uint8_t need, done; /* bytes of the current character: still needed, and read */
    uint8_t low, high;  /* valid range of its next byte */
};
size_t utf8_feed(struct utf8_reader *reader, const void *piece, size_t n);

/* Makes s fit for a one-line message: malformed bytes become "?"; control characters (C0, C1, DEL) and
 * line and paragraph separators (U+2028, U+2029) become spaces. */
void utf8_mend(char *s);

/* Converts byte offsets in well-formed text to UTF-16 offsets. Caches the last one, so that ascending
 * offsets cost a single pass. Begins zeroed. */
struct utf16_counter {
    size_t bytes, units;
};
size_t utf16_offset(struct utf16_counter *counter, const char *s, size_t byte);

/* The inverse: byte offset of a UTF-16 unit, at most n. The same counter may serve both. */
size_t utf16_byte(struct utf16_counter *counter, const char *s, size_t n, size_t units);

/* Returns the offset of the first character, from `at` on, other than printable ASCII, white space, Latin
 * letters and signs (U+00A0 to U+024F), common punctuation (U+2010 to U+2026) and currency signs (U+20A0 to
 * U+20BF); n if every character is one of these. The text must be well-formed. Examines several bytes per
 * step. */
size_t utf8_skip_latin(const char *s, size_t n, size_t at);

/* Overwrites text with white space of the same length in bytes and UTF-16 units. Keeps line ends. */
void utf8_blank(char *s, size_t n);

/* Converts byte offsets to line and column, both from 1; columns are in characters. */

/* Caches the last position: finding the next one costs the distance between them. Begins zeroed. */
struct lines {
    size_t byte;         /* last position */
    size_t line, column; /* 0-based */
};

/* Line and column of s[byte]. byte is at most the length of s, which must be the same text in every call. */
void lines_place(struct lines *lines, const char *s, size_t byte, size_t *line, size_t *column);

#endif
