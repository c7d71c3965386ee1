/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internals of the normalizers: a language file, its templates, and the kinds of text. */
#ifndef FACCIA_NORMALIZE_NORMALIZERS_INTERNAL_H
#define FACCIA_NORMALIZE_NORMALIZERS_INTERNAL_H

#include "server/normalize/normalizers.h"

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

#endif
