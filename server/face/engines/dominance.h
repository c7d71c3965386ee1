/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coarticulation function of LUCIA (Leone, "LUCIA-WebGL", chapter 3.4; Cosi and Perin, ICMI 2002, after
 * Cohen and Massaro 1993): one curve for one articulatory parameter, from the targets of its segments. */
#ifndef FACCIA_FACE_ENGINES_DOMINANCE_H
#define FACCIA_FACE_ENGINES_DOMINANCE_H

#include "server/face/packs/speech_pack_content.h"

/* Resistance from which a segment confines its neighbours. */
#define DOMINANCE_RESISTANT 0.97

/* Maximum reach of a segment, in segments, which bounds the cost of sampling. */
enum { DOMINANCE_REACH = 8 };

/* tau = time from the target instant, s. */
double dominance_degree(const struct coefficients *c, double tau); /* D, (3.3) */
double dominance_shape(const struct coefficients *c, double tau, double h_bw,
                       double h_fw);                               /* S look-ahead, (3.14) */
double dominance_resistance(double tau, double h_bw, double h_fw); /* R, (3.15) */

struct curve_segment {
    double at; /* target instant, s */
    struct coefficients c;
    double h_bw, h_fw; /* distance to the resistant neighbours' targets, s; infinite without one */
    double from, to;   /* range in which R exceeds 1e-5 */
};

struct curve {
    struct curve_segment *segments; /* strictly increasing in `at` */
    size_t count, cap;
    /* Between segments i-1 and i only [first[i], last[i]] have an effect. */
    uint32_t *first, *last;
};

/* Position of the last instant, and the number of segments evaluated so far. Zero-initialised. */
struct curve_cursor {
    size_t next; /* the first segment with a later target */
    uint64_t evaluated;
};

/* Appends a segment. Skips one without dominance, which contributes nothing, or with a target not after
 * the last one's. */
void curve_add(struct curve *curve, double at, const struct coefficients *c);

/* Computes h_bw and h_fw by the recursion of (3.15) and what depends on them. Call once, after the last
 * curve_add. */
void curve_link(struct curve *curve);

/* Replaces curve_link: makes F(t) the original function (3.2) of Cohen and Massaro, with S = R = 1 and one
 * c, the mean of both, on both sides of the target. The reach is limited to ORIGINAL_REACH s, which bounds
 * the cost of sampling. */
#define ORIGINAL_REACH 4.0
void curve_link_original(struct curve *curve);

/* The same with both c: no segment is confined. */
void curve_link_unconfined(struct curve *curve);

/* F(t), (3.16). Constant before the first and after the last target. */
double curve_at(const struct curve *curve, double t, struct curve_cursor *cursor);

void curve_free(struct curve *curve);

#endif
