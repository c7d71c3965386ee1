/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/original.h"

/* As tests/bench/baseline.c prints them for Italian prose of 20 s at 80, 160 and 320 words a minute. */
static const struct {
    double extent, degree;
} factors[PARAM_COUNT] = {
    [PARAM_LI] = {10.00, 1.8}, /* 1.60 mm from the way through the targets; with {3.16, 1} 1.72 */
    [PARAM_LS] = {10.00, 1.8}, /* 0.51 mm from the way through the targets; with {3.16, 1} 0.55 */
    [PARAM_AR] = {25.12, 1.8}, /* 1.19 mm from the way through the targets; with {3.16, 1} 1.50 */
    [PARAM_PI] = {15.85, 1.8}, /* 0.27 mm from the way through the targets; with {3.16, 1} 0.31 */
    [PARAM_PS] = {12.59, 1.6}, /* 0.31 mm from the way through the targets; with {3.16, 1} 0.36 */
    [PARAM_EM] = {3.16, 1.0},  /* 0.81 mm from the way through the targets; with {3.16, 1} 0.81 */
    [PARAM_TH] = {50.12, 2.0}, /* 1.88 mm from the way through the targets; with {3.16, 1} 2.24 */
    [PARAM_TA] = {2.51, 0.8},  /* 0.41 mm from the way through the targets; with {3.16, 1} 0.45 */
    [PARAM_TB] = {2.51, 1.0},  /* 1.16 mm from the way through the targets; with {3.16, 1} 1.18 */
};

struct coefficients original_coefficients(const struct coefficients *c, int param) {
    struct coefficients out = *c;
    out.theta_bw *= factors[param].extent;
    out.theta_fw *= factors[param].extent;
    out.c_bw *= factors[param].degree;
    out.c_fw *= factors[param].degree;
    return out;
}
