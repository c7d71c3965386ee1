/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/fit/unknowns.h"
#include <math.h>

enum scale { SCALE_FREE, SCALE_EVEN, SCALE_LOGARITHMIC };

#define FIELD(name) offsetof(struct coefficients, name)

static const struct unknown {
    size_t field, twin; /* twin is set to the same value */
    enum scale scale;
    double min, max;
} look_ahead[UNKNOWNS_LOOK_AHEAD] =
    {
        {FIELD(t), FIELD(t), SCALE_EVEN, 0.02, 0.98},
        {FIELD(T), FIELD(T), SCALE_FREE, -50, 50},
        {FIELD(alpha), FIELD(alpha), SCALE_EVEN, 0.005, 1},
        {FIELD(theta_bw), FIELD(theta_bw), SCALE_LOGARITHMIC, 0.1, 2000},
        {FIELD(theta_fw), FIELD(theta_fw), SCALE_LOGARITHMIC, 0.1, 2000},
        {FIELD(c_bw), FIELD(c_bw), SCALE_LOGARITHMIC, 0.2, 5},
        {FIELD(c_fw), FIELD(c_fw), SCALE_LOGARITHMIC, 0.2, 5},
        {FIELD(p_bw), FIELD(p_bw), SCALE_LOGARITHMIC, 0.2, 5},
        {FIELD(p_fw), FIELD(p_fw), SCALE_LOGARITHMIC, 0.2, 5},
        {FIELD(beta_bw), FIELD(beta_bw), SCALE_EVEN, -5, 5},
        {FIELD(beta_fw), FIELD(beta_fw), SCALE_EVEN, -5, 5},
},
  original[UNKNOWNS_ORIGINAL] = {
      {FIELD(t), FIELD(t), SCALE_EVEN, 0.02, 0.98},
      {FIELD(T), FIELD(T), SCALE_FREE, -50, 50},
      {FIELD(alpha), FIELD(alpha), SCALE_EVEN, 0.005, 1},
      {FIELD(theta_bw), FIELD(theta_bw), SCALE_LOGARITHMIC, 0.1, 2000},
      {FIELD(theta_fw), FIELD(theta_fw), SCALE_LOGARITHMIC, 0.1, 2000},
      {FIELD(c_bw), FIELD(c_fw), SCALE_LOGARITHMIC, 0.2, 5},
};

static const struct unknown *unknowns(enum targets_function function) {
    return function == TARGETS_ORIGINAL ? original : look_ahead;
}

size_t unknowns_count(enum targets_function function) {
    return function == TARGETS_ORIGINAL ? UNKNOWNS_ORIGINAL : UNKNOWNS_LOOK_AHEAD;
}

/* A start is never nearer to a limit than this part of the way between both: from there it could not move. */
#define MARGIN 0.01

static double to_unknown(const struct unknown *u, double value) {
    if (u->scale == SCALE_FREE)
        return value;
    double part = u->scale == SCALE_EVEN ? (value - u->min) / (u->max - u->min)
                                         : log(fmax(value, u->min) / u->min) / log(u->max / u->min);
    part = fmin(fmax(part, MARGIN), 1 - MARGIN);
    return log(part / (1 - part));
}

static double to_value(const struct unknown *u, double x) {
    if (u->scale == SCALE_FREE)
        return fmin(fmax(x, u->min), u->max);
    double part = 1 / (1 + exp(-x));
    return u->scale == SCALE_EVEN ? u->min + part * (u->max - u->min) : u->min * pow(u->max / u->min, part);
}

void unknowns_of(enum targets_function function, const struct coefficients *c, double *x) {
    for (size_t i = 0; i < unknowns_count(function); i++) {
        const struct unknown *u = &unknowns(function)[i];
        x[i] = to_unknown(u, *(const double *)((const char *)c + u->field));
    }
}

void unknowns_to(enum targets_function function, const double *x, struct coefficients *c) {
    for (size_t i = 0; i < unknowns_count(function); i++) {
        const struct unknown *u = &unknowns(function)[i];
        double value = to_value(u, x[i]);
        *(double *)((char *)c + u->field) = value;
        *(double *)((char *)c + u->twin) = value;
    }
}

bool unknowns_at_limit(double x, size_t unknown) {
    double margin = log((1 - MARGIN) / MARGIN);
    return look_ahead[unknown].scale != SCALE_FREE && fabs(x) > margin + 1e-9;
}

struct coefficients unknowns_start(bool strong, bool vowel) {
    double theta = vowel ? 9 : strong ? 20 : 6;
    return (struct coefficients){.alpha = strong ? 0.95 : 0.15,
                                 .k = strong,
                                 .theta_bw = theta,
                                 .theta_fw = theta,
                                 .c_bw = 1,
                                 .c_fw = 1,
                                 .p_bw = 1,
                                 .p_fw = 1,
                                 .beta_bw = 0.025,
                                 .beta_fw = 0.025};
}
