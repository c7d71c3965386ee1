#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints the expected values of test_dominance.c, straight from the formulas of E. Leone, "LUCIA-WebGL", chapter 3.4, with no
regard to speed: every segment counts at every instant, and h is found by the recursion as it is written."""
from math import exp, inf

NAMES = "t T alpha k theta_bw theta_fw c_bw c_fw p_bw p_fw beta_bw beta_fw".split()


def coefficients(*values):
    return dict(zip(NAMES, values))


def D(c, tau):  # (3.3)
    side = "bw" if tau < 0 else "fw"
    return c["alpha"] * exp(-c["theta_" + side] * abs(tau) ** c["c_" + side])


def S(c, tau, h):  # (3.14)
    side = "bw" if tau < 0 else "fw"
    return c["beta_" + side] * abs(tau / h[side]) ** c["p_" + side] + 1


def R(tau, h):  # (3.15)
    return exp(-6 * abs(tau / h["bw" if tau < 0 else "fw"]) ** 4)


def h_of(segments, i, step):
    j = i + step
    if not 0 <= j < len(segments):
        return inf
    distance = abs(segments[j][0] - segments[i][0])
    return distance if segments[j][1]["k"] >= 0.97 else distance + h_of(segments, j, step)


def F(segments, t):  # (3.16)
    above = below = 0
    for i, (at, c) in enumerate(segments):
        h = {"bw": h_of(segments, i, -1), "fw": h_of(segments, i, 1)}
        weight = R(t - at, h) * D(c, t - at)
        above += c["T"] * S(c, t - at, h) * weight
        below += weight
    return above / below


P = coefficients(0.33, -2, 1, 1, 8.907, 3, 0.881, 2.072, 1, 1, 0.025, 0.025)  # table 3.2
M = coefficients(0.14, -0.2, 1, 1, 8.907, 3, 0.386, 0.595, 1, 1, 0.025, 0.025)  # table 3.2
V = coefficients(0.5, 9, 1, 0.5, 6, 7, 1.2, 1.1, 2, 1.5, 0.3, -0.2)
W = coefficients(0.5, 5, 0.4, 0.2, 10, 12, 0.9, 1, 1, 1, 0.1, 0.1)
REST = coefficients(0.5, 0, 1, 1, 7, 7, 1, 1, 1, 1, 0, 0)
# Gaps of every length, weak neighbours in a row, resistant neighbours in a row.
SEGMENTS = [(0, REST), (0.12, V), (0.2, P), (0.23, W), (0.3, V), (0.34, W), (0.39, V), (0.5, M), (0.58, P), (0.7, V), (0.9, REST)]

if __name__ == "__main__":
    for name, c in (("P", P), ("V", V)):
        for tau in (-0.1, -0.02, 0.03, 0.15):
            h = {"bw": 0.12, "fw": 0.2}
            print(f"{name} tau {tau}: D {D(c, tau):.12f} S {S(c, tau, h):.12f} R {R(tau, h):.12f}")
    for i in range(len(SEGMENTS)):
        print(f"h of {i}: {h_of(SEGMENTS, i, -1):.12f} {h_of(SEGMENTS, i, 1):.12f}")
    for n in range(1, 18):
        print(f"F({n * 0.05:.2f}) = {F(SEGMENTS, n * 0.05):.12f}")
