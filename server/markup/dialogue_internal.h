/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of dialogues. */
#ifndef FACCIA_MARKUP_DIALOGUE_INTERNAL_H
#define FACCIA_MARKUP_DIALOGUE_INTERNAL_H

#include "server/markup/speaker_runs.h"
#include <stdbool.h>
#include <stddef.h>

/* ---- words by which a narrator tells who speaks, by language ---- */

/* Lists are in lower case, with a space before and after each word. */
struct dialogue_words {
    const char *lang;
    const char *verbs;                  /* of speaking, as they follow or precede a quotation */
    const char *male, *female, *titles; /* before a name, or in Turkish after it; titles: of either sex */
    const char *between;                /* may stand between verb and name */
    const char *pronouns;               /* beside a verb: somebody else speaks */
    const char *before;                 /* prepositions: the name after them is not who speaks */
    const char *others; /* written with a capital at the beginning of a sentence, and not a name */
    const char *articles;
    const char *endings; /* of gerunds and participles, by which the narrator goes on after a comma */
    const char *manner;  /* words by which the narrator goes on after a comma */
    const char *quote;   /* may stand between a speech and its verb ("diye"); "": none */
    bool verb_last;      /* the verb stands at the end of its sentence */
};

/* NULL: none for the language. */
const struct dialogue_words *dialogue_words_of(const char *lang);

bool dialogue_word_in(const char *list, const char *word);

/* ---- the narrator's words inside a speech that a dash begins, between commas ---- */

/* Finds the first such words ("— Vieni, disse Anna, è tardi.") in text[from..to): *begins is after the mark
 * before them, *ends after the mark that ends them. lang: BCP 47; NULL, or one without a table of verbs: none
 * are found. */
bool dialogue_aside(const char *text, size_t from, size_t to, const char *lang, size_t *begins, size_t *ends);

/* True if one of the last four words of text[from..to) (last false: of the first four) is a verb of speaking,
 * or if the language has no table of verbs. */
bool dialogue_verb_near(const char *text, size_t from, size_t to, bool last, const char *lang);

/* ---- who speaks: by the narrator's words ("disse Renzo", "Mr. Brown said:"), and between two named persons
 * by taking turns ---- */

/* A paragraph with speech. */
struct dialogue_turn {
    size_t from, to;     /* bytes of the paragraph */
    size_t first, count; /* its runs */
    bool begins;         /* a dialogue */
    bool goes_on;        /* its first quotation was opened in an earlier paragraph */
    bool apart;          /* it follows a paragraph without speech */
};

/* Adds a speaker for each person who is named, and gives the turns of this person to it. Other turns of a
 * dialogue with names are given to speaker `unsure`; a dialogue without names is left as it is. lang: of the
 * narrator (BCP 47); without words for it, nothing changes. */
void dialogue_name(struct speaker_runs *runs, const struct dialogue_turn *turns, size_t count,
                   const char *text, const char *lang, size_t unsure);

#endif
