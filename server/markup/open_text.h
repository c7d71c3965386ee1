/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cuts a text that is still being written into pieces of about a sentence, to be read early. Where a piece
 * ends depends on the text alone, not on how it arrived: a piece is complete once no continuation could
 * change its end. */
#ifndef FACCIA_MARKUP_OPEN_TEXT_H
#define FACCIA_MARKUP_OPEN_TEXT_H

#include "server/markup/markup.h"

/* Start tag of an open element. */
struct open_element {
    size_t start, end; /* bytes of the text */
};

/* Zeroed at first, except `kind`. */
struct open_text {
    const struct markup_kind *kind; /* as requested; once `found`, the actual kind */
    bool found;
    bool markdown;                 /* plain text of kind "auto": Markdown marks are not spoken */
    size_t at;                     /* bytes of the text returned so far */
    bool goes_on;                  /* the next piece continues the line of the last one */
    struct open_element *elements; /* open at `at`, outermost first */
    size_t element_count, element_cap;
};

enum {
    OPEN_PIECE_BYTES = 8192, /* including tags; a longer piece is cut at a tag */
    OPEN_ELEMENTS = 64,      /* nested */
};

/* A document to be read as open_text.kind: `lead` bytes of start tags for the enclosing elements, then the
 * piece of `length` bytes, which begins at byte `start` of the text, then the end tags. */
struct open_piece {
    char *text; /* freed by the caller */
    size_t size, lead, start, length;
};

enum open_end {
    OPEN_GOES_ON, /* more may follow */
    OPEN_FLUSHED, /* end the piece here, before any incomplete character or tag */
    OPEN_CLOSED,  /* the text is complete */
};

/* Returns the next piece of text[0..size), UTF-8 that may end inside a character. 1: *piece is set; 0: no
 * piece is complete yet; -1 with *e: "bad-field" (a markup that can only be read as a whole), "bad-xml",
 * "too-deep". */
int open_text_next(struct open_text *o, const char *text, size_t size, enum open_end end,
                   const struct markup_rules *rules, struct open_piece *piece, struct error *e);

/* True if the remaining text looks like whole sentences, so that waiting longer would hardly help. */
bool open_text_seems_ended(const struct open_text *o, const char *text, size_t size,
                           const struct markup_rules *rules);

/* True if the remaining text is one plain sentence that almost certainly ends here: there are no quotes,
 * numbers, names or abbreviations near its end. */
bool open_text_surely_ended(const struct open_text *o, const char *text, size_t size,
                            const struct markup_rules *rules);

/* Converts a byte of the piece's document to a byte of the text, and the position of an error likewise. */
size_t open_piece_byte(const struct open_piece *piece, size_t byte);
void open_piece_place(const struct open_piece *piece, const char *text, struct error *e);

void open_text_free(struct open_text *o);

#endif
