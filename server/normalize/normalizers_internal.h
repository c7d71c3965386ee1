/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of the reader: a language's file, what fills its templates, and the kinds of text. */
#ifndef FACCIA_NORMALIZE_NORMALIZERS_INTERNAL_H
#define FACCIA_NORMALIZE_NORMALIZERS_INTERNAL_H

#include "server/normalize/normalizers.h"

struct normalizer {
    json_t *root;
    const char *tag;
    char decimal, thousands; /* in its numbers */
};

enum { NORMALIZER_TEXT_MAX = 256 }; /* longer texts are not read in a special way, bytes */

/* A number of digits, maybe grouped, maybe with decimals, without a sign. */
struct number {
    char whole[32], decimals[16]; /* digits; decimals "" = none */
};

/* A number at the beginning of the text. Returns its bytes, 0 when there is none. */
size_t number_read(const struct normalizer *normalizer, const char *text, struct number *number);
/* 1..3999 in Roman digits, the whole text. False when it is none. */
bool number_roman(const char *text, struct number *number);
/* As the language writes it, without groups. */
void number_write(const struct normalizer *normalizer, const struct number *number, struct buf *out);
bool number_is_one(const struct number *number);

/* Replaces {NAME} by values, which are pairs of name and value ended by NULL. */
void template_fill(struct buf *out, const char *template, const char *const *values);

/* The string at a path of members; NULL when it is not there. */
const char *normalizer_string(const struct normalizer *normalizer, const char *member, const char *name);

/* The forms of one and of many, of an array of two. */
const char *normalizer_form(const json_t *forms, bool one);

/* One for each kind; text is trimmed. */
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
