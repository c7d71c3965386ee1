/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Language tags (BCP 47). */
#ifndef FACCIA_BASE_LANG_H
#define FACCIA_BASE_LANG_H

/* The tag, or the one that it stands for: a macrolanguage for the language that is usually meant by it ("zh"
 * for Mandarin, RFC 5646, 4.1.2), a code that ISO 639 has given up for its successor ("iw" for "he"). Static,
 * or the argument. */
const char *lang_usual(const char *tag);

#endif
