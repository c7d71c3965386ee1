/* SPDX-License-Identifier: GPL-3.0-or-later */
/* UTF-8 (RFC 3629): no overlong forms, no surrogates, nothing above U+10FFFF. */
#ifndef FACCIA_BASE_UTF8_H
#define FACCIA_BASE_UTF8_H

#include <stddef.h>
#include <stdint.h>

/* Decodes the character at s (n > 0 bytes). Returns its length 1..4 and the code point in *cp, or 0 when it
 * is malformed. */
size_t utf8_next(const char *s, size_t n, uint32_t *cp);

/* Writes cp to out (4 bytes) and returns the length, 0 when cp is no character. */
size_t utf8_put(uint32_t cp, char *out);

/* Offset of the first malformed byte, or n when all is well. */
size_t utf8_check(const char *s, size_t n);

/* The same for a text that comes in pieces. Begins zeroed. Returns the offset in the piece of the byte at
 * which a character, that began `done` bytes before, turned out to be malformed; or n. A character is
 * incomplete at the end of the text when it needs more. */
struct utf8_reader {
    uint8_t need, done; /* bytes of the present character */
    uint8_t low, high;  /* between which its next one must lie */
};
size_t utf8_feed(struct utf8_reader *reader, const void *piece, size_t n);

/* Makes s fit for a message of one line: malformed bytes become "?", control characters (C0, C1, DEL) and
 * the separators of lines and paragraphs (U+2028, U+2029) spaces. */
void utf8_mend(char *s);

/* Converts byte offsets of one well-formed text to offsets in UTF-16 units. Remembers where it was: offsets
 * that mostly rise cost a single pass over the text. Begins zeroed. */
struct utf16_counter {
    size_t bytes, units;
};
size_t utf16_offset(struct utf16_counter *counter, const char *s, size_t byte);

/* The other way: the byte that a UTF-16 unit begins at, at most n. The same counter may serve both. */
size_t utf16_byte(struct utf16_counter *counter, const char *s, size_t n, size_t units);

/* White space in place of text: of as many bytes and of as many UTF-16 units. Line ends stay. */
void utf8_blank(char *s, size_t n);

#endif
