/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coarticulation function of LUCIA (Leone, "LUCIA-WebGL", chapter 3.4; Cosi and Perin, ICMI 2002, after
 * Cohen and Massaro 1993): one curve for one articulatory parameter, from the targets of its segments. */
#ifndef FACCIA_FACE_ENGINES_DOMINANCE_H
#define FACCIA_FACE_ENGINES_DOMINANCE_H

#include "server/face/packs/speech_pack_content.h"

/* Resistance from which a segment stops the segments of its neighbours. */
#define DOMINANCE_RESISTANT 0.97

/* No segment reaches across more segments than this, resistant or not: it bounds the cost of one instant. */
enum { DOMINANCE_REACH = 8 };

/* tau = time from the target instant, s. */
double dominance_degree(const struct coefficients *c, double tau); /* D, (3.3) */
double dominance_shape(const struct coefficients *c, double tau, double h_bw,
                       double h_fw);                               /* S look-ahead, (3.14) */
double dominance_resistance(double tau, double h_bw, double h_fw); /* R, (3.15) */

struct curve_segment {
    double at; /* target instant, s */
    struct coefficients c;
    double h_bw, h_fw; /* distance to the resistant neighbours' targets, s; infinite where there is none */
    double from, to;   /* where R is more than 1e-5 */
};

struct curve {
    struct curve_segment *segments; /* at rises strictly */
    size_t count, cap;
    /* Between segments i-1 and i only [first[i], last[i]] have any effect. */
    uint32_t *first, *last;
};

/* Where in the curve the last instant lay, and how many segments have been evaluated so far. Begins as
 * zeros. */
struct curve_cursor {
    size_t next; /* the first segment whose target comes later */
    uint64_t evaluated;
};

/* Adds a segment behind the others. One that has no dominance adds nothing to any sum and is left out, as is
 * one whose target does not come after the last one's. */
void curve_add(struct curve *curve, double at, const struct coefficients *c);

/* Fills h_bw and h_fw by the recursion of (3.15) and what follows from them. Call once, after the last
 * curve_add. */
void curve_link(struct curve *curve);

/* Instead of curve_link: makes F(t) the original function (3.2) of Cohen and Massaro, where S = R = 1 and one
 * c, here the mean of both, serves before and after the target. No segment is felt for more than
 * ORIGINAL_REACH s: it bounds the cost of one instant. */
#define ORIGINAL_REACH 4.0
void curve_link_original(struct curve *curve);

/* The same with both c: no segment is confined. */
void curve_link_unconfined(struct curve *curve);

/* F(t), (3.16). Before the first target and after the last one: that target. */
double curve_at(const struct curve *curve, double t, struct curve_cursor *cursor);

void curve_free(struct curve *curve);

#endif
