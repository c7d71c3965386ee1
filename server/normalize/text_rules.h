/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules for reading running text in a language: its numbers, signs and abbreviations, and their words.
 * Each language is a file in models/normalization/text (see README.md there). */
#ifndef FACCIA_NORMALIZE_TEXT_RULES_H
#define FACCIA_NORMALIZE_TEXT_RULES_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

/* A part of a text as spoken: a range of the words, and the bytes of the text that they stand for. */
struct said_part {
    size_t offset, bytes;
    size_t from, to;
    bool verbatim; /* the words equal the text */
    bool guess;    /* the rule that made the words is only usually right */
};

struct said {
    struct buf words;
    struct said_part *parts; /* cover the words, in order */
    size_t part_count, part_cap;
};

struct text_rules;

/* Loads a file. Its member "regions" may override values for a region; region "" applies no overrides.
 * Returns NULL with *e ("bad-normalization"). */
struct text_rules *text_rules_load(const char *path, const char *region, struct error *e);
/* Compiles all regular expressions, which otherwise happens when each is first tried. Returns -1 with *e
 * if one is invalid. */
int text_rules_check(struct text_rules *rules, struct error *e);
void text_rules_free(struct text_rules *rules);

/* The language's tag, and the regions of its file (an object by BCP 47 tag, or NULL). */
const char *text_rules_tag(const struct text_rules *rules);
json_t *text_rules_regions(const struct text_rules *rules);

/* Format: see markup_rules.abbreviations. */
const char *const *text_rules_abbreviations(const struct text_rules *rules);
/* Format: see markup_rules.line_words. NULL: none. */
const char *const *text_rules_line_words(const struct text_rules *rules);

/* Puts well-formed text into words. rules NULL: a language without a file; letters are only composed.
 * Thread-safe. Returns false if the words equal the text; *said is empty then. */
bool text_rules_say(struct text_rules *rules, const char *stretch, size_t size, struct said *said);
void said_free(struct said *said);

#endif
