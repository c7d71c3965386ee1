/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FACCIA_BASE_SMOOTHSTEP_H
#define FACCIA_BASE_SMOOTHSTEP_H

/* Eases from 0 to 1: 3 x^2 - 2 x^3, constant beyond both. */
static inline double smoothstep(double x) {
    return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x);
}

#endif
