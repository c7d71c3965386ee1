/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/unknowns.h"
#include <math.h>

enum scale { SCALE_TARGET, SCALE_EVEN, SCALE_LOGARITHMIC };

#define FIELD(name) offsetof(struct coefficients, name)

/* Spread: of a target in mm, as people differ from each other by a few; of the others in x, half to double of
 * an extent, a third of the phone for the place of the target. */
static const struct unknown {
    size_t field, twin; /* twin is set to the same value */
    enum scale scale;
    double min, max, spread;
} look_ahead[UNKNOWNS_LOOK_AHEAD] =
    {
        {FIELD(t), FIELD(t), SCALE_EVEN, 0.02, 0.98, 0.7},
        {FIELD(T), FIELD(T), SCALE_TARGET, 0, 0, 1.5},
        {FIELD(alpha), FIELD(alpha), SCALE_EVEN, 0.005, 1, 1},
        {FIELD(theta_bw), FIELD(theta_bw), SCALE_LOGARITHMIC, 1, 100, 0.7},
        {FIELD(theta_fw), FIELD(theta_fw), SCALE_LOGARITHMIC, 1, 100, 0.7},
        {FIELD(c_bw), FIELD(c_bw), SCALE_LOGARITHMIC, 0.3, 3, 0.6},
        {FIELD(c_fw), FIELD(c_fw), SCALE_LOGARITHMIC, 0.3, 3, 0.6},
        {FIELD(p_bw), FIELD(p_bw), SCALE_LOGARITHMIC, 0.3, 3, 0.4},
        {FIELD(p_fw), FIELD(p_fw), SCALE_LOGARITHMIC, 0.3, 3, 0.4},
        {FIELD(beta_bw), FIELD(beta_bw), SCALE_EVEN, -2, 2, 0.3},
        {FIELD(beta_fw), FIELD(beta_fw), SCALE_EVEN, -2, 2, 0.3},
},
  original[UNKNOWNS_ORIGINAL] = {
      {FIELD(t), FIELD(t), SCALE_EVEN, 0.02, 0.98, 0.7},
      {FIELD(T), FIELD(T), SCALE_TARGET, 0, 0, 1.5},
      {FIELD(alpha), FIELD(alpha), SCALE_EVEN, 0.005, 1, 1},
      {FIELD(theta_bw), FIELD(theta_bw), SCALE_LOGARITHMIC, 1, 100, 0.7},
      {FIELD(theta_fw), FIELD(theta_fw), SCALE_LOGARITHMIC, 1, 100, 0.7},
      {FIELD(c_bw), FIELD(c_fw), SCALE_LOGARITHMIC, 0.3, 3, 0.6},
};

/* How far a mouth goes from rest, mm: lips are soft and can be pressed by 3, no jaw sinks by more than 30
 * (the widest opening of adults is about 50 between the incisors, which speech does not come near). */
static const struct {
    double min, max;
} anatomy[PARAM_COUNT] = {
    [PARAM_LI] = {-3, 22},  [PARAM_LS] = {-3, 10},  [PARAM_AR] = {-18, 12},
    [PARAM_PI] = {-7, 9},   [PARAM_PS] = {-5, 9},   [PARAM_EM] = {-1, 30},
    [PARAM_TH] = {-18, 14}, [PARAM_TA] = {-12, 14}, [PARAM_TB] = {-16, 16},
};

static const struct unknown *unknowns(enum targets_function function) {
    return function == TARGETS_ORIGINAL ? original : look_ahead;
}

size_t unknowns_count(enum targets_function function) {
    return function == TARGETS_ORIGINAL ? UNKNOWNS_ORIGINAL : UNKNOWNS_LOOK_AHEAD;
}

double unknowns_spread(enum targets_function function, size_t unknown) {
    return unknowns(function)[unknown].spread;
}

/* A start is never nearer to a limit than this part of the way between both: from there it could not move. */
#define MARGIN 0.01

static double to_unknown(const struct unknown *u, double value) {
    double part = u->scale == SCALE_EVEN ? (value - u->min) / (u->max - u->min)
                                         : log(fmax(value, u->min) / u->min) / log(u->max / u->min);
    part = fmin(fmax(part, MARGIN), 1 - MARGIN);
    return log(part / (1 - part));
}

static double to_value(const struct unknown *u, double x) {
    double part = 1 / (1 + exp(-x));
    return u->scale == SCALE_EVEN ? u->min + part * (u->max - u->min) : u->min * pow(u->max / u->min, part);
}

double unknowns_limited(int p, double T) {
    return fmin(fmax(T, anatomy[p].min), anatomy[p].max);
}

/* The way that x makes of the start within the limits, made from the value itself: it may lie on a limit, or
 * beyond. */
static double moved(const struct unknown *u, double own, double x) {
    double start = to_unknown(u, own), from = to_value(u, start), to = to_value(u, start + x);
    double value = u->scale == SCALE_EVEN ? own + to - from : own * to / from;
    return fmin(fmax(value, fmin(own, u->min)), fmax(own, u->max));
}

struct coefficients unknowns_moved(enum targets_function function, const struct coefficients *base, int p,
                                   const double *x) {
    struct coefficients c = *base;
    for (size_t i = 0; i < unknowns_count(function) && base->alpha > 0; i++) {
        const struct unknown *u = &unknowns(function)[i];
        double own = *(const double *)((const char *)base + u->field);
        if (x[i] == 0)
            continue;
        double value = u->scale == SCALE_TARGET ? unknowns_limited(p, own + x[i]) : moved(u, own, x[i]);
        *(double *)((char *)&c + u->field) = value;
        *(double *)((char *)&c + u->twin) = value;
    }
    return c;
}
