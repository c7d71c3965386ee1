/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups phones that look alike on a recorded speaker (Leone, "LUCIA-WebGL", chapter 3.2: visemes from
 * measured lips). Each phone is the mean of its measured parameters over the middle half of its occurrences,
 * in units of the pooled standard deviation within phones. Groups are merged by Ward's criterion (Ward,
 * 1963): each merge is the one that increases the sum of squares within groups least. */
#ifndef FACCIA_RESEARCH_VISEME_GROUPS_H
#define FACCIA_RESEARCH_VISEME_GROUPS_H

#include "server/base/buf.h"
#include "server/research/measured_speech.h"

enum { VISEME_PHONES = 120 };

struct viseme_phone {
    char ipa[PHONE_NAME_BYTES];
    size_t count;             /* occurrences */
    double mean[PARAM_COUNT]; /* mm; 0 where not recorded */
};

/* Joins the nodes a and b: a node below phone_count is a phone, others are earlier merges. */
struct viseme_merge {
    size_t a, b;
    size_t phones; /* in the result */
    double height; /* distance of the groups: sqrt(2 n m / (n + m)) times that of their means, as in R and
                      SciPy */
};

struct viseme_tree {
    struct viseme_phone phones[VISEME_PHONES]; /* by first occurrence */
    size_t phone_count;
    bool recorded[PARAM_COUNT];
    double deviation[PARAM_COUNT]; /* mm: pooled, within phones; at least 0.1 */
    struct viseme_merge merges[VISEME_PHONES];
    size_t order[VISEME_PHONES]; /* phones from top to bottom of the tree */
};

/* Phones with fewer occurrences than `least` are left out. -1 with *e ("bad-curves") if fewer than three
 * remain, or more than VISEME_PHONES. */
int viseme_tree_make(const struct measured_speech *recordings, size_t count, size_t least,
                     struct viseme_tree *out, struct error *e);

/* Cuts the tree into so many groups: group[i] is that of phone i, from 0 in the order of the tree. */
void viseme_tree_cut(const struct viseme_tree *tree, size_t groups, size_t group[VISEME_PHONES]);

/* Number of groups, at least 2, with the greatest mean silhouette (Rousseeuw, 1987), and that silhouette. */
size_t viseme_tree_best(const struct viseme_tree *tree, double *silhouette);

/* Appends the tree as an SVG 1.1 document, the groups in colours. */
void viseme_tree_draw(const struct viseme_tree *tree, size_t groups, struct buf *out);

#endif
