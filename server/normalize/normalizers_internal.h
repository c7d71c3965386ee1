/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internals of the normalizers: a language file, its templates, and the kinds of text. */
#ifndef FACCIA_NORMALIZE_NORMALIZERS_INTERNAL_H
#define FACCIA_NORMALIZE_NORMALIZERS_INTERNAL_H

#include "server/normalize/normalizers.h"

#include <stdbool.h>
#include <stddef.h>
#include <unicode/utypes.h>

struct normalizer {
    json_t *root;
    const char *tag;
    char decimal, thousands; /* separators in its numbers */
};

enum { NORMALIZER_TEXT_MAX = 256 }; /* bytes; longer texts get no special reading */

/* An unsigned number, possibly grouped or with decimals. */
struct number {
    char whole[32], decimals[16]; /* digits; decimals "" = none */
};

/* Parses a number at the beginning of the text. Returns its length in bytes, 0 if there is none. */
size_t number_read(const struct normalizer *normalizer, const char *text, struct number *number);
/* Parses a Roman numeral, 1 to 3999, which must be the whole text. */
bool number_roman(const char *text, struct number *number);
/* Writes the number as the language does, without grouping. */
void number_write(const struct normalizer *normalizer, const struct number *number, struct buf *out);
bool number_is_one(const struct number *number);

/* Replaces {NAME} by its value; values: pairs of name and value, ended by NULL. */
void template_fill(struct buf *out, const char *template, const char *const *values);

/* Returns the string root[member][name], or root[member] if name is NULL; NULL if it is missing. */
const char *normalizer_string(const struct normalizer *normalizer, const char *member, const char *name);

/* Singular or plural of an array [SINGULAR, PLURAL]. */
const char *normalizer_form(const json_t *forms, bool one);

/* One function per kind of text; text is trimmed. False if it is not of that kind. */
bool normalize_ordinal(const struct normalizer *normalizer, const char *text, struct buf *out);
bool normalize_fraction(const struct normalizer *normalizer, const char *text, struct buf *out);
bool normalize_date(const struct normalizer *normalizer, const char *format, const char *text,
                    struct buf *out);
bool normalize_time(const struct normalizer *normalizer, const char *format, const char *text,
                    struct buf *out);
bool normalize_duration(const struct normalizer *normalizer, const char *text, struct buf *out);
bool normalize_currency(const struct normalizer *normalizer, const char *text, struct buf *out);
bool normalize_measure(const struct normalizer *normalizer, const char *text, struct buf *out);

/* A stretch of text as the rules of a language see it: UTF-16 with composed letters, and for each unit the
 * bytes of the stretch that it stands for. */

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
