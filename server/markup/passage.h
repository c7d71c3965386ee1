/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marked-up text between two hard boundaries (ends of paragraphs, of the document...) while it is collected:
 * flat text without tags, and pieces that record where it came from and how to say it. A complete passage is
 * cut into sentences like plain text, and added to the score.
 *
 * Styles and cues apply to whole words. One that begins or ends inside a word is extended to the whole word,
 * with a warning; if several share a word, the innermost wins. */
#ifndef FACCIA_MARKUP_PASSAGE_H
#define FACCIA_MARKUP_PASSAGE_H

#include "server/base/buf.h"
#include "server/markup/markup_rules.h"
#include "server/markup/score.h"
#include <stdint.h>

/* A part of the input of one kind and style. */
struct piece {
    enum score_kind kind;
    bool verbatim;      /* its text is input[start..end) */
    bool given;         /* what the author says in place of the text */
    bool atomic;        /* indivisible: no sentence, style or word crosses its ends */
    size_t flat, bytes; /* its text in the flat text; other kinds: position */
    size_t start, end;  /* bytes of the input */
    const char *name;   /* SCORE_MARK, SCORE_AUDIO; belongs to the score */
    double seconds;     /* SCORE_BREAK */
    size_t until;       /* SCORE_AUDIO: index of the piece after its alternate content */
    const struct score_style *style;
    size_t depth; /* depth of the element that set the style */
};

/* Range of a cue or style, from start tag to end tag. */
struct span {
    size_t cue; /* index in the score; SPAN_STYLE: a style only */
    size_t at, depth;
    size_t first, last;           /* pieces [first, last) */
    size_t first_flat, last_flat; /* the same range in the flat text */
    bool begun, ended;            /* begun: its beginning is in the score already */
    bool back;                    /* begins at first_flat, before its first piece */
};
#define SPAN_STYLE SIZE_MAX
enum { PASSAGE_OPEN = 256 }; /* maximum number of open spans */

struct passage {
    struct score *score;
    const char *text;          /* input */
    struct markup_rules rules; /* for its sentences */
    struct buf flat;
    struct piece *pieces;
    size_t piece_count, piece_cap;
    struct span *spans;
    size_t span_count, span_cap;
    size_t open[PASSAGE_OPEN]; /* open spans, outermost first */
    size_t open_count;
    size_t *barriers; /* offsets in the flat text that no word crosses; ascending */
    size_t barrier_count, barrier_cap;
    size_t *cuts; /* beginnings of cues from passage_last_word; ascending */
    size_t cut_count, cut_cap;
    size_t warned;   /* position of the last warning about a word, plus 1 */
    bool line_ended; /* the flat text ends with white space that contains a line end */
    struct word {    /* last words found by passage_word, to find each only once */
        size_t from, to;
    } words[2];
    size_t flushes;
    bool whole; /* the passage is a single sentence */
};

void passage_free(struct passage *p);

/* Adds text[0..n), which represents input[start..end). */
void passage_text(struct passage *p, const char *text, size_t n, struct piece piece);
/* Adds a break, mark or sound. Returns its index. */
size_t passage_add(struct passage *p, struct piece piece);

/* Opens a span here. False if too many are open; the span is empty then. */
bool passage_open(struct passage *p, size_t cue, size_t at, size_t depth);
/* Moves the beginning of the newest span back to that piece. */
void passage_from(struct passage *p, size_t piece);
/* Closes the spans of that depth and deeper ones. */
void passage_close(struct passage *p, size_t depth);
/* Hands the open spans of an element to the one around it. */
void passage_lift(struct passage *p, size_t depth);
/* Places a cue over the last word before this point, or at the point if there is none. */
void passage_last_word(struct passage *p, size_t cue, size_t at);

/* Adds the collected text to the score and empties the passage. Open spans stay open. */
void passage_flush(struct passage *p);

/* markup_words.c: finds the word around an offset of the flat text. False if the offset lies between
 * words. slot: 0 or 1, where the word is cached. Requires a complete passage. */
bool passage_word(struct passage *p, size_t slot, size_t flat, struct word *word);
/* Finds the last word of the flat text. False if there is none near the end. */
bool passage_word_before(const struct passage *p, struct word *word);

#endif
