/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The markup stage: a text in one of the accepted kinds becomes a score. */
#ifndef FACCIA_MARKUP_MARKUP_H
#define FACCIA_MARKUP_MARKUP_H

#include "server/markup/score.h"

/* How a language cuts its sentences. */
struct markup_rules {
    const char *const *abbreviations; /* NULL-terminated, lower case, without the final dot; may be NULL */
};

/* One reader. */
struct markup_kind {
    const char *name;         /* "plain": the value of the request's `markup` */
    const char *content_type; /* "text/plain": the media type that selects it over HTTP */
    int (*read)(struct score *score, const char *text, size_t size, const struct markup_rules *rules,
                struct error *e);
};

/* The kinds on offer, ended by a name of NULL. */
extern const struct markup_kind markup_kinds[];

/* NULL when there is none of that name, or content type (parameters such as charset are passed over). */
const struct markup_kind *markup_by_name(const char *name);
const struct markup_kind *markup_by_content_type(const char *type);

/* Reads UTF-8 text[0..size). NULL with *e: "bad-utf8", "nul" (byte), "empty-text", or what the reader says.
 */
struct score *markup_read(const struct markup_kind *kind, const char *text, size_t size,
                          const struct markup_rules *rules, struct error *e);

#endif
