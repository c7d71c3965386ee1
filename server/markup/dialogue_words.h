/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words by which a narrator tells who speaks, by language. Lists are in lower case, with a space before and
 * after each word. */
#ifndef FACCIA_MARKUP_DIALOGUE_WORDS_H
#define FACCIA_MARKUP_DIALOGUE_WORDS_H

#include <stdbool.h>

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

#endif
