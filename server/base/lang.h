/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Language tags (BCP 47). */
#ifndef FACCIA_BASE_LANG_H
#define FACCIA_BASE_LANG_H

#include <stdbool.h>
#include <stddef.h>

/* The longest tag, in bytes (RFC 5646, 4.4.1). */
enum { LANG_BYTES = 35 };

/* True if s[0..n) has the syntax of a BCP 47 tag: subtags of 1 to 8 letters and digits separated by
 * hyphens; the first has 2 to 8 letters, or is "x" or "i". Accepts voices' own tags ("en-us-nyc"), too.
 * *bad is the first offending byte. */
bool lang_is_tag(const char *s, size_t n, size_t *bad);

/* Reads a tag, or a POSIX locale with territory or codeset ("it_IT", "pt_BR.UTF-8", "ca_ES@valencia"),
 * whose modifier is dropped; "ita" and "IT" become "it". Returns false, with *bad as above, if it is neither.
 */
bool lang_read(const char *s, size_t n, char tag[LANG_BYTES + 1], size_t *bad);

/* Replaces a macrolanguage with the language usually meant ("zh" becomes Mandarin, RFC 5646, 4.1.2), and a
 * withdrawn ISO 639 code with its successor ("iw" becomes "he"). Returns a static string or the argument. */
const char *lang_usual(const char *tag);

/* Compares a language with the wanted one: LANG_SAME the same tag, 2 a variety of it ("en" finds "en-GB"),
 * 1 the same language, 0 another. Tags are normalised with lang_usual. */
enum { LANG_SAME = 3 };
int lang_fit(const char *lang, const char *wanted);

#endif
