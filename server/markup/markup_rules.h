/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a reader of texts is told by its caller. */
#ifndef FACCIA_MARKUP_MARKUP_RULES_H
#define FACCIA_MARKUP_MARKUP_RULES_H

#include "server/base/error.h"
#include "server/base/work_limit.h"
#include "server/markup/affects.h"
#include <stdbool.h>
#include <stddef.h>

/* How a language cuts its sentences. */
struct markup_rules {
    /* NULL-terminated, lower case, without the final dot; may be NULL. "?ecc": it ends a sentence when a
     * capital follows; "+no": it ends none when a number follows; "#": numbers with a dot are ordinals. */
    const char *const *abbreviations;
    const char *lang; /* BCP 47, of the request: a style that means the same leaves it open; may be NULL */
    size_t sentence_bytes; /* a sentence that is longer is cut at a comma, semicolon or colon; 0 = where it is
                              longer than any sentence may be (plain.h) */
    bool more;             /* the text is still being written: more may follow (plain.h) */
    bool markdown;         /* lines may be headings and items, words may be marked, as Markdown does */
    bool markdown_out;     /* of a whole plain text: what Markdown writes, and emoji, are left out first */
    const struct affects *affects;    /* that the text can name; may be NULL: then names stay as they are */
    const struct language_runs *runs; /* of a plain text: what is in another language; may be NULL */
    bool lenient;  /* nobody said what the text is: tags in what is no document are left out, not an error */
    double paused; /* s: pauses that the text had before this piece of it */
    struct work_limit *limit; /* when it is over, reading ends soon, with the error "cancelled" or
                                 "text-too-long"; may be NULL */
};

static inline bool markup_given_up(const struct markup_rules *rules) {
    return rules && work_limit_over(rules->limit);
}

/* Why a reading was given up: the code, and what is said of it. */
static inline const char *markup_why_given_up(const struct markup_rules *rules, enum error_code *code) {
    *code = rules->limit->late ? ERROR_TEXT_TOO_LONG : ERROR_CANCELLED;
    return rules->limit->late ? "reading it takes too long" : "it was cancelled";
}

#endif
