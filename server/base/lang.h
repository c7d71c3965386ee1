/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Language tags (BCP 47). */
#ifndef FACCIA_BASE_LANG_H
#define FACCIA_BASE_LANG_H

#include <stdbool.h>
#include <stddef.h>

/* The longest tag, in bytes (RFC 5646, 4.4.1). */
enum { LANG_BYTES = 35 };

/* Whether s[0..n) has a tag's form: subtags of 1 to 8 letters and digits, the first one of 2 to 8 letters, or
 * "x" or "i", with hyphens between. That is the syntax that all of BCP 47's tags have, and voices' own
 * ("en-us-nyc") besides. *bad is the byte where it ends to have it. */
bool lang_is_tag(const char *s, size_t n, size_t *bad);

/* Writes the tag of s[0..n), which may also be the name of a POSIX locale with a territory or a codeset
 * ("it_IT", "pt_BR.UTF-8", "ca_ES@valencia": its modifier is left out). False, and *bad as above, when it is
 * neither. */
bool lang_read(const char *s, size_t n, char tag[LANG_BYTES + 1], size_t *bad);

/* The tag, or the one that it stands for: a macrolanguage for the language that is usually meant by it ("zh"
 * for Mandarin, RFC 5646, 4.1.2), a code that ISO 639 has given up for its successor ("iw" for "he"). Static,
 * or the argument. */
const char *lang_usual(const char *tag);

#endif
