/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads pronunciation lexicons (W3C PLS 1.0, Recommendation of 14 October 2008). */
#ifndef FACCIA_MARKUP_PLS_H
#define FACCIA_MARKUP_PLS_H

#include "server/markup/markup_rules.h"
#include "server/markup/score.h"

enum {
    PLS_GRAPHEME_BYTES = 200,
    PLS_ALIAS_BYTES = 1000,
    PLS_PHONES_BYTES = 500,
    PLS_GRAPHEMES = 50, /* in one lexeme */
};

/* A lexeme: the spellings of a word, and how to say each of them. Exists while pls_sink.lexeme runs. */
struct pls_lexeme {
    const char *graphemes[PLS_GRAPHEMES]; /* trimmed, with single spaces */
    size_t places[PLS_GRAPHEMES];         /* bytes of the input */
    size_t count;
    const char *alias; /* text to speak instead; NULL: ipa */
    const char *ipa;
    bool any_case; /* matches in upper and lower case */
};

struct pls_sink {
    void (*language)(void *ctx, const char *lang);              /* called first; lang: BCP 47 */
    void (*lexeme)(void *ctx, const struct pls_lexeme *lexeme); /* in the order of the document */
    void *ctx;
    size_t left_out; /* lexemes with a fault, each with a warning */
};

/* Reads well-formed or malformed input text[0..size). Faults that cost at most a lexeme become warnings of
 * the score, whose input must be the text. Returns -1 with *e: "bad-utf8", "nul", "bad-xml" and the other
 * errors of XML; "bad-lexicon" if the root is not a lexicon with a language. */
int pls_read(struct score *score, struct pls_sink *sink, struct error *e);

#endif
