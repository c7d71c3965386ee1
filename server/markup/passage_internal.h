/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of a passage's way into the score: runs of one style, and zones that no sentence ends in. */
#ifndef FACCIA_MARKUP_PASSAGE_INTERNAL_H
#define FACCIA_MARKUP_PASSAGE_INTERNAL_H

#include "server/markup/passage.h"

/* A part of a piece that has one style and belongs to one set of words. */
struct run {
    size_t piece; /* never falls from run to run */
    size_t from, to;
    const struct piece *of;
    const struct score_style *style;
};

/* A part of the flat text that no sentence ends in. */
struct zone {
    size_t from, to;
};

struct flush {
    struct passage *p;
    struct run *runs;
    size_t run_count, run_cap;
    size_t *marks; /* that lie inside a word, which ends at marks_until: they go behind it */
    size_t mark_count, mark_cap, marks_until;
    size_t cut;
    struct word styled; /* the last word that has a style of its own, and that */
    const struct score_style *word_style;
    struct zone *zones;
    size_t zone_count, zone_cap, zone;
    struct run *placed; /* where the new items came from */
    size_t placed_count, placed_cap, first_item;
};

/* passage_runs.c */
void passage_make_runs(struct flush *f);
void passage_make_zones(struct flush *f);
void passage_warn_word(struct passage *p, size_t at, const char *what); /* once for a place */

#endif
