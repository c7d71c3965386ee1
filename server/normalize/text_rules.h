/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the running text of a language is read: which numbers, signs and short forms there are, and the words
 * for them. Each language is a file of models/normalization/text (see README.md there). */
#ifndef FACCIA_NORMALIZE_TEXT_RULES_H
#define FACCIA_NORMALIZE_TEXT_RULES_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

/* A part of a text as it is said: bytes of the words, and the bytes of the text that they stand for. */
struct said_part {
    size_t offset, bytes;
    size_t from, to;
    bool verbatim; /* the words are exactly the text */
    bool guess;    /* the rule that made the words is often right, not always */
};

struct said {
    struct buf words;
    struct said_part *parts; /* cover the words, in order */
    size_t part_count, part_cap;
};

struct text_rules;

/* One file. Its member "regions" may hold what is different in a region; region "" = nothing of that. NULL
 * with *e ("bad-normalization"). */
struct text_rules *text_rules_load(const char *path, const char *region, struct error *e);
/* Expressions are made when they are first tried; this makes all. -1 with *e when one is broken. */
int text_rules_check(struct text_rules *rules, struct error *e);
void text_rules_free(struct text_rules *rules);

/* Its language, and what its file says of regions (an object by BCP 47 tag, or NULL). */
const char *text_rules_tag(const struct text_rules *rules);
json_t *text_rules_regions(const struct text_rules *rules);

/* As markup_rules.abbreviations. */
const char *const *text_rules_abbreviations(const struct text_rules *rules);

/* Reads a stretch of well-formed text. rules NULL = a language without a file: its letters are composed.
 * Thread-safe. False when nothing is said otherwise than it is written; then *said is empty. */
bool text_rules_say(struct text_rules *rules, const char *stretch, size_t size, struct said *said);
void said_free(struct said *said);

#endif
