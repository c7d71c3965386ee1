/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text that is still being written, and what of it can be read already: piece by piece, about a sentence
 * each. Where a piece ends follows from the text alone, however it came: a piece is known once nothing that
 * may follow could change its end. */
#ifndef FACCIA_MARKUP_OPEN_TEXT_H
#define FACCIA_MARKUP_OPEN_TEXT_H

#include "server/markup/markup.h"

/* An element of the text that is open: its start tag. */
struct open_element {
    size_t start, end; /* bytes of the text */
};

/* Begins zeroed, but for `kind`. */
struct open_text {
    const struct markup_kind *kind; /* as it is asked for; once `found`, what the text is */
    bool found;
    bool markdown;                 /* it was found to be plain: what Markdown writes is not spoken */
    size_t at;                     /* so many bytes of the text have been given out */
    bool goes_on;                  /* what comes next stands in the line of what was given out last */
    struct open_element *elements; /* that are open there, the outermost first */
    size_t element_count, element_cap;
};

enum {
    OPEN_PIECE_BYTES = 8192, /* of text and tags; a piece with more ends at a tag */
    OPEN_ELEMENTS = 64,      /* in each other */
};

/* A document of its own, to be read with open_text.kind: `lead` bytes that open the elements that the piece
 * lies in, then the piece, which stands at byte `start` of the text, then what closes the elements. */
struct open_piece {
    char *text; /* to be freed */
    size_t size, lead, start, length;
};

enum open_end {
    OPEN_GOES_ON, /* more may follow */
    OPEN_FLUSHED, /* a piece ends here, as far as what is written is whole */
    OPEN_CLOSED,  /* nothing follows */
};

/* The next piece of text[0..size), UTF-8 which may end inside a character. 1; 0: nothing more is known; -1
 * with *e: "bad-field" of a markup that can only be read as a whole, "bad-xml", "too-deep". */
int open_text_next(struct open_text *o, const char *text, size_t size, enum open_end end,
                   const struct markup_rules *rules, struct open_piece *piece, struct error *e);

/* Whether what was not given out looks like whole sentences, so that little is to be won by waiting. */
bool open_text_seems_ended(const struct open_text *o, const char *text, size_t size,
                           const struct markup_rules *rules);

/* Whether what was not given out is one plain sentence whose end can hardly be anything else: no quotes,
 * numbers, names or abbreviations are near it. */
bool open_text_surely_ended(const struct open_text *o, const char *text, size_t size,
                            const struct markup_rules *rules);

/* A byte of the piece's document, as a byte of the text; and the place of an error likewise. */
size_t open_piece_byte(const struct open_piece *piece, size_t byte);
void open_piece_place(const struct open_piece *piece, const char *text, struct error *e);

void open_text_free(struct open_text *o);

#endif
