/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds who speaks in a dialogue: by the narrator's words ("disse Renzo", "Mr. Brown said:"), and between two
 * named persons by taking turns. */
#ifndef FACCIA_MARKUP_DIALOGUE_NAMES_H
#define FACCIA_MARKUP_DIALOGUE_NAMES_H

#include "server/markup/speaker_runs.h"
#include <stdbool.h>

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
