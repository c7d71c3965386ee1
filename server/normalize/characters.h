/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stretch of text as the rules of a language see it: UTF-16 with composed letters, and for each unit the
 * bytes of the stretch that it stands for. */
#ifndef FACCIA_NORMALIZE_CHARACTERS_H
#define FACCIA_NORMALIZE_CHARACTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <unicode/utypes.h>

struct characters {
    UChar *text;
    size_t *from, *to; /* bytes of the stretch, for each unit */
    size_t size, cap;
    bool changed; /* at least one unit differs from the stretch */
};

/* Composes letters with their accents (NFC). Ligatures and full-width, mathematical and circled characters
 * become the plain characters that they stand for (NFKC). Other compatibility characters stay, because
 * their meaning differs (2 and superscript 2). Removes directional controls, soft hyphens, what
 * characters_unspoken names, and combining marks beyond CHARACTERS_MARKS on one letter. stretch: well-formed
 * UTF-8. */
enum { CHARACTERS_MARKS = 8 };
void characters_read(struct characters *characters, const char *stretch, size_t size);
void characters_free(struct characters *characters);

/* Tells whether a character cannot be spoken although it may carry meaning: private use, unassigned, a
 * control character other than white space, or U+FFFD, which marks text lost earlier. */
bool characters_unspoken(UChar32 character);

/* True for a combining mark, and for a character that only overrides or isolates the writing direction. */
bool characters_is_mark(UChar32 character);
bool characters_is_direction(UChar32 character);

#endif
