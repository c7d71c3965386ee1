/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/original.h"

/* As tests/bench/baseline.c prints them for Italian prose of 20 s at 80, 160 and 320 words a minute. */
static const struct {
    double extent, degree;
} factors[PARAM_COUNT] = {
    [PARAM_LI] = {3.16, 1.2},  /* 1.31 mm from the way through the targets; with {3.16, 1} 1.34 */
    [PARAM_LS] = {6.31, 1.6},  /* 0.51 mm from the way through the targets; with {3.16, 1} 0.54 */
    [PARAM_AR] = {6.31, 1.4},  /* 1.21 mm from the way through the targets; with {3.16, 1} 1.25 */
    [PARAM_PI] = {5.01, 1.2},  /* 0.23 mm from the way through the targets; with {3.16, 1} 0.23 */
    [PARAM_PS] = {6.31, 1.4},  /* 0.26 mm from the way through the targets; with {3.16, 1} 0.27 */
    [PARAM_EM] = {3.16, 1.0},  /* 0.82 mm from the way through the targets; with {3.16, 1} 0.82 */
    [PARAM_TH] = {19.95, 1.8}, /* 1.83 mm from the way through the targets; with {3.16, 1} 2.11 */
    [PARAM_TA] = {2.51, 0.8},  /* 0.41 mm from the way through the targets; with {3.16, 1} 0.44 */
    [PARAM_TB] = {2.51, 1.0},  /* 1.11 mm from the way through the targets; with {3.16, 1} 1.16 */
};

struct coefficients original_coefficients(const struct coefficients *c, int param) {
    struct coefficients out = *c;
    out.theta_bw = out.theta_fw = factors[param].extent * (c->theta_bw + c->theta_fw) / 2;
    out.c_bw *= factors[param].degree;
    out.c_fw *= factors[param].degree;
    return out;
}
