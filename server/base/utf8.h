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

/* Makes s fit for a message of one line: malformed bytes become "?", control characters spaces. */
void utf8_mend(char *s);

/* Converts byte offsets of one well-formed text to offsets in UTF-16 units. Remembers where it was: offsets
 * that mostly rise cost a single pass over the text. Begins zeroed. */
struct utf16_counter {
    size_t bytes, units;
};
size_t utf16_offset(struct utf16_counter *counter, const char *s, size_t byte);

#endif
