/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The score: what the markup stage hands to the voice stage. A list of items in reading order, cut into
 * sentences; every item knows which bytes of the input it came from. All strings belong to the score. */
#ifndef FACCIA_MARKUP_SCORE_H
#define FACCIA_MARKUP_SCORE_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stddef.h>

enum score_kind {
    SCORE_TEXT,  /* text to be spoken in one style */
    SCORE_BREAK, /* a pause of `seconds` */
    SCORE_MARK,  /* a name to be reported when it is reached */
};

enum score_emphasis { EMPHASIS_NONE, EMPHASIS_REDUCED, EMPHASIS_WEAK, EMPHASIS_MEDIUM, EMPHASIS_STRONG };

/* Emotion over a stretch of text; envelope times in seconds, intensity and weight 0..1. */
struct score_emotion {
    const char *name; /* an entry of the expressions file; NULL = neutral */
    double intensity, weight;
    double delay, onset, offset;
};

/* How a stretch is to be said. Factors multiply the voice's own value; 1 = unchanged. */
struct score_style {
    const char *lang;  /* BCP 47; NULL = the request's */
    const char *voice; /* NULL = the request's */
    double rate, pitch, range, volume;
    enum score_emphasis emphasis;
    const char *say_as;   /* NULL, or how to read it: "digits", "date:dmy"... */
    const char *phonemes; /* NULL, or IPA that replaces the text */
    struct score_emotion emotion;
};

struct score_item {
    enum score_kind kind;
    size_t start, end; /* bytes of the input */
    const char *text;  /* SCORE_TEXT: UTF-8; SCORE_MARK: the name */
    bool verbatim;     /* text is exactly input[start..end), so offsets inside it map one to one */
    double seconds;    /* SCORE_BREAK */
    const struct score_style *style; /* never NULL */
};

/* Items first..first+count of a score: one sentence, the unit that flows through the stages. */
struct score_sentence {
    size_t first, count;
    size_t start, end; /* bytes of the input */
};

struct score {
    struct score_item *items;
    size_t item_count, item_cap;
    struct score_sentence *sentences;
    size_t sentence_count, sentence_cap;
    struct error *warnings; /* what was not acted on, with its place */
    size_t warning_count, warning_cap;
    struct score_block *blocks; /* owns strings and styles */
};

/* The style that changes nothing. */
extern const struct score_style score_plain_style;

struct score *score_new(void);
void score_free(struct score *score);

/* Copies that live as long as the score. */
const char *score_strndup(struct score *score, const char *s, size_t n);
const struct score_style *score_keep_style(struct score *score, const struct score_style *style);

struct score_item *score_add(struct score *score, enum score_kind kind, size_t start, size_t end);

/* Closes the sentence that began after the last closed one. Does nothing when it has no items. */
void score_end_sentence(struct score *score);

#endif
