/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A passage of marked-up text between two hard boundaries (the ends of paragraphs, of a document...), as it
 * is collected: its text flat, without the tags, and pieces that know where it came from and how it is to be
 * said. When it is complete it is cut into sentences as plain text is, and goes to the score.
 *
 * Styles and cues hold for whole words. One that begins or ends inside a word is moved outwards, with a
 * warning; of several that share a word the innermost counts. */
#ifndef FACCIA_MARKUP_PASSAGE_H
#define FACCIA_MARKUP_PASSAGE_H

#include "server/base/buf.h"
#include "server/markup/markup_rules.h"
#include "server/markup/score.h"
#include <stdint.h>

/* A piece of the input that is one thing. */
struct piece {
    enum score_kind kind;
    bool verbatim;      /* its text is input[start..end) */
    bool atomic;        /* stands for itself: no sentence, no style and no word crosses its ends */
    size_t flat, bytes; /* its text in the flat text; others: the point where they stand */
    size_t start, end;  /* bytes of the input */
    const char *name;   /* SCORE_MARK, SCORE_AUDIO; belongs to the score */
    double seconds;     /* SCORE_BREAK */
    size_t until;       /* SCORE_AUDIO: its alternate content ends before this piece */
    const struct score_style *style;
    size_t depth; /* of the element that set the style */
};

/* A stretch of text with a cue or a style of its own, from its start tag to its end tag. */
struct span {
    size_t cue; /* index into the score's; SPAN_STYLE = a style alone */
    size_t at, depth;
    size_t first, last;           /* pieces [first, last) */
    size_t first_flat, last_flat; /* the same places in the flat text */
    bool begun, ended;            /* begun: the score knows its beginning already */
    bool back;                    /* it began before its first piece, at first_flat, which is known */
};
#define SPAN_STYLE SIZE_MAX
enum { PASSAGE_OPEN = 256 }; /* spans open at a time */

struct passage {
    struct score *score;
    const char *text; /* the input */
    const struct markup_rules *rules;
    struct buf flat;
    struct piece *pieces;
    size_t piece_count, piece_cap;
    struct span *spans;
    size_t span_count, span_cap;
    size_t open[PASSAGE_OPEN]; /* spans that have not ended, outer ones first */
    size_t open_count;
    size_t *barriers; /* places in the flat text over which no word goes; rising */
    size_t barrier_count, barrier_cap;
    size_t *cuts; /* where cues begin that were asked for later; rising */
    size_t cut_count, cut_cap;
    size_t warned;   /* the place of the last warning about a word, and one */
    bool line_ended; /* the white space at the end of the flat text holds a line end */
    struct word {    /* looked up last, at beginnings and at ends of spans: so a word is looked for once */
        size_t from, to;
    } words[2];
    size_t flushes;
    bool whole; /* all of it is one sentence */
};

void passage_free(struct passage *p);

/* Adds text[0..n), which stands for input[start..end). */
void passage_text(struct passage *p, const char *text, size_t n, struct piece piece);
/* Adds a break, a mark or a sound. Returns its index. */
size_t passage_add(struct passage *p, struct piece piece);

/* Opens a span here. False when too many are open: then it is empty. */
bool passage_open(struct passage *p, size_t cue, size_t at, size_t depth);
/* Moves the beginning of the span opened last back to that piece. */
void passage_from(struct passage *p, size_t piece);
/* Closes the spans of that depth or deeper. */
void passage_close(struct passage *p, size_t depth);
/* Makes the open spans of a depth those of the depth above. */
void passage_lift(struct passage *p, size_t depth);
/* A cue over the last word before this point; at the point when there is none. */
void passage_last_word(struct passage *p, size_t cue, size_t at);

/* Hands all that was collected to the score. Spans stay open. */
void passage_flush(struct passage *p);

/* words.c: the word that the place in the flat text lies inside of. False when it lies between words. slot, 0
 * or 1, is where the word is remembered. Only for a complete passage. */
bool passage_word(struct passage *p, size_t slot, size_t flat, struct word *word);
/* The last word before the end of the flat text. False when there is none near. */
bool passage_word_before(const struct passage *p, struct word *word);

#endif
