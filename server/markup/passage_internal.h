/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internals of adding a passage to the score: runs of one style, and zones in which no sentence may end. */
#ifndef FACCIA_MARKUP_PASSAGE_INTERNAL_H
#define FACCIA_MARKUP_PASSAGE_INTERNAL_H

#include "server/markup/passage.h"

/* A part of a piece with a single style. */
struct run {
    size_t piece; /* index; never decreases from run to run */
    size_t from, to;
    const struct piece *of;
    const struct score_style *style;
};

/* A range of the flat text in which no sentence may end. */
struct zone {
    size_t from, to;
};

struct flush {
    struct passage *p;
    struct run *runs;
    size_t run_count, run_cap;
    size_t *marks; /* marks inside a word that ends at marks_until; they follow it */
    size_t mark_count, mark_cap, marks_until;
    size_t cut;
    struct word styled; /* cache of word_style: the last word and its style */
    const struct score_style *word_style;
    struct zone *zones;
    size_t zone_count, zone_cap, zone;
    struct run *placed; /* origin of each new item */
    size_t placed_count, placed_cap, first_item;
};

/* passage_runs.c */
void passage_make_runs(struct flush *f);
void passage_make_zones(struct flush *f);
void passage_warn_word(struct passage *p, size_t at, const char *what); /* at most once per position */

#endif
