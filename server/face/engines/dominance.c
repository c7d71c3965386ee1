/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/dominance.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

#define RESISTANCE_SLOPE 6.0
/* (ln(1e5) / 6)^(1/4): |tau / h| at which R has fallen to 1e-5. */
#define RESISTANCE_END 1.1770
/* Limits the exponent so that the sum of weights stays above the smallest double, however far the targets
 * are. */
#define MAX_EXPONENT 600.0

/* most exponents are 1 */
static double power(double x, double exponent) {
    return exponent == 1 ? x : pow(x, exponent);
}

static double degree_exponent(const struct coefficients *c, double tau) {
    return tau < 0 ? c->theta_bw * power(-tau, c->c_bw) : c->theta_fw * power(tau, c->c_fw);
}

double dominance_degree(const struct coefficients *c, double tau) {
    return c->alpha * exp(-degree_exponent(c, tau));
}

double dominance_shape(const struct coefficients *c, double tau, double h_bw, double h_fw) {
    return tau < 0 ? c->beta_bw * power(-tau / h_bw, c->p_bw) + 1
                   : c->beta_fw * power(tau / h_fw, c->p_fw) + 1;
}

static double resistance_exponent(double tau, double h_bw, double h_fw) {
    double x = tau / (tau < 0 ? h_bw : h_fw);
    return RESISTANCE_SLOPE * x * x * x * x;
}

double dominance_resistance(double tau, double h_bw, double h_fw) {
    return exp(-resistance_exponent(tau, h_bw, h_fw));
}

void curve_add(struct curve *curve, double at, const struct coefficients *c) {
    if (c->alpha <= 0 || (curve->count && at <= curve->segments[curve->count - 1].at))
        return;
    curve->segments = mem_grow(curve->segments, &curve->cap, curve->count + 1, sizeof *curve->segments);
    curve->segments[curve->count++] = (struct curve_segment){.at = at, .c = *c};
}

/* The recursion in one direction: h is the distance to the neighbour's target plus, if that does not
 * resist, the neighbour's h. `passed` counts the segments reached across. */
static void fill_h(struct curve *curve, bool forward) {
    double h = INFINITY;
    int passed = 0;
    for (size_t n = 0; n < curve->count; n++) {
        size_t i = forward ? curve->count - 1 - n : n;
        struct curve_segment *s = &curve->segments[i];
        if (n) {
            const struct curve_segment *neighbour = &curve->segments[forward ? i + 1 : i - 1];
            double step = fabs(neighbour->at - s->at);
            bool stops = neighbour->c.k >= DOMINANCE_RESISTANT || passed >= DOMINANCE_REACH;
            passed = stops ? 0 : passed + 1;
            h = stops ? step : step + h;
        }
        *(forward ? &s->h_fw : &s->h_bw) = h;
    }
}

/* Computes the range of segments with an effect in each gap between targets, limited to `reach` gaps. Both
 * ends only increase. */
static void fill_ranges(struct curve *curve, size_t reach) {
    size_t count = curve->count, first = 0, last = count;
    curve->first = mem_resize(NULL, (count + 1) * sizeof *curve->first);
    curve->last = mem_resize(NULL, (count + 1) * sizeof *curve->last);
    for (size_t gap = 0; gap <= count; gap++) {
        while (first < gap &&
               (first + reach < gap || curve->segments[first].to <= curve->segments[gap - 1].at))
            first++;
        curve->first[gap] = (uint32_t)first;
    }
    for (size_t gap = count + 1; gap-- > 0;) {
        while (last > gap &&
               (last > gap + reach || curve->segments[last - 1].from >= curve->segments[gap].at))
            last--;
        curve->last[gap] = (uint32_t)last;
    }
}

/* No segment reaches beyond DOMINANCE_REACH segments, but R has a short tail. */
enum { SEARCH = 2 * DOMINANCE_REACH };

void curve_link(struct curve *curve) {
    fill_h(curve, true);
    fill_h(curve, false);
    for (size_t i = 0; i < curve->count; i++) {
        struct curve_segment *s = &curve->segments[i];
        s->from = s->at - RESISTANCE_END * s->h_bw;
        s->to = s->at + RESISTANCE_END * s->h_fw;
    }
    fill_ranges(curve, SEARCH);
}

/* Smaller effects are ignored. */
#define ORIGINAL_LEAST 1e-4
/* Number of segments of fast speech within ORIGINAL_REACH. */
enum { ORIGINAL_SEARCH = 100 };

static double original_reach(double theta, double c) {
    double reach = theta > 0 ? pow(-log(ORIGINAL_LEAST) / theta, 1 / c) : ORIGINAL_REACH;
    return fmin(reach, ORIGINAL_REACH);
}

void curve_link_unconfined(struct curve *curve) {
    for (size_t i = 0; i < curve->count; i++) {
        struct curve_segment *s = &curve->segments[i];
        s->h_bw = s->h_fw = INFINITY; /* then R = S = 1 */
        s->from = s->at - original_reach(s->c.theta_bw, s->c.c_bw);
        s->to = s->at + original_reach(s->c.theta_fw, s->c.c_fw);
        /* between two distant segments both have an effect */
        if (i)
            s->from = fmin(s->from, s[-1].at);
        if (i + 1 < curve->count)
            s->to = fmax(s->to, s[1].at);
    }
    fill_ranges(curve, ORIGINAL_SEARCH);
}

void curve_link_original(struct curve *curve) {
    for (size_t i = 0; i < curve->count; i++) {
        struct coefficients *c = &curve->segments[i].c;
        c->c_bw = c->c_fw = (c->c_bw + c->c_fw) / 2;
    }
    curve_link_unconfined(curve);
}

static size_t seek(const struct curve *curve, double t, size_t next) {
    if (next > curve->count || (next && curve->segments[next - 1].at > t))
        next = 0;
    /* Steps linearly first, then by bisection. */
    for (int step = 0; step < 4; step++) {
        if (next == curve->count || curve->segments[next].at > t)
            return next;
        next++;
    }
    size_t high = curve->count;
    while (next < high) {
        size_t mid = (next + high) / 2;
        if (curve->segments[mid].at > t)
            high = mid;
        else
            next = mid + 1;
    }
    return next;
}

double curve_at(const struct curve *curve, double t, struct curve_cursor *cursor) {
    if (!curve->count)
        return 0;
    size_t gap = cursor->next = seek(curve, t, cursor->next);
    if (gap == 0)
        return curve->segments[0].c.T;
    if (gap == curve->count)
        return curve->segments[curve->count - 1].c.T;
    double above = 0, below = 0;
    for (size_t i = curve->first[gap]; i < curve->last[gap]; i++) {
        const struct curve_segment *s = &curve->segments[i];
        if (t <= s->from || t >= s->to)
            continue;
        double tau = t - s->at;
        double exponent = degree_exponent(&s->c, tau) + resistance_exponent(tau, s->h_bw, s->h_fw);
        double weight = s->c.alpha * exp(-(exponent < MAX_EXPONENT ? exponent : MAX_EXPONENT));
        above += s->c.T * dominance_shape(&s->c, tau, s->h_bw, s->h_fw) * weight;
        below += weight;
        cursor->evaluated++;
    }
    return above / below;
}

void curve_free(struct curve *curve) {
    free(curve->segments);
    free(curve->first);
    free(curve->last);
    *curve = (struct curve){0};
}
