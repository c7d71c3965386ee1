/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expected values come from dominance_reference.py, which contains only the formulas. */
#include "server/face/engines/dominance.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

#define NEAR(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static const struct coefficients P = {0.33, -2, 1, 1, 8.907, 3, 0.881, 2.072, 1, 1, 0.025, 0.025};
static const struct coefficients M = {0.14, -0.2, 1, 1, 8.907, 3, 0.386, 0.595, 1, 1, 0.025, 0.025};
static const struct coefficients V = {0.5, 9, 1, 0.5, 6, 7, 1.2, 1.1, 2, 1.5, 0.3, -0.2};
static const struct coefficients W = {0.5, 5, 0.4, 0.2, 10, 12, 0.9, 1, 1, 1, 0.1, 0.1};
static const struct coefficients REST = {0.5, 0, 1, 1, 7, 7, 1, 1, 1, 1, 0, 0};

static struct curve sample_curve(void) {
    struct curve curve = {0};
    curve_add(&curve, 0, &REST);
    curve_add(&curve, 0.12, &V);
    curve_add(&curve, 0.2, &P);
    curve_add(&curve, 0.23, &W);
    curve_add(&curve, 0.3, &V);
    curve_add(&curve, 0.34, &W);
    curve_add(&curve, 0.39, &V);
    curve_add(&curve, 0.5, &M);
    curve_add(&curve, 0.58, &P);
    curve_add(&curve, 0.7, &V);
    curve_add(&curve, 0.9, &REST);
    curve_link(&curve);
    return curve;
}

static void follows_the_formulas(void **state) {
    (void)state;
    static const struct {
        const struct coefficients *c;
        double tau, d, s, r;
    } expected[] = {
        {&P, -0.10, 0.309910802111, 1.020833333333, 0.055381010291},
        {&P, -0.02, 0.752953379961, 1.004166666667, 0.995381070587},
        {&P, 0.03, 0.997904628211, 1.003750000000, 0.996967108536},
        {&P, 0.15, 0.942818041892, 1.018750000000, 0.149802502864},
        {&V, -0.10, 0.684837012705, 1.208333333333, 0.055381010291},
        {&V, -0.02, 0.946601945529, 1.008333333333, 0.995381070587},
        {&V, 0.03, 0.862528157752, 0.988381049961, 0.996967108536},
        {&V, 0.15, 0.419556448641, 0.870096189432, 0.149802502864},
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        NEAR(dominance_degree(expected[i].c, expected[i].tau), expected[i].d, 1e-11);
        NEAR(dominance_shape(expected[i].c, expected[i].tau, 0.12, 0.2), expected[i].s, 1e-11);
        NEAR(dominance_resistance(expected[i].tau, 0.12, 0.2), expected[i].r, 1e-11);
    }
    assert_true(dominance_degree(&W, 0) == 0.4);
    assert_true(dominance_shape(&V, 0, 0.1, 0.1) == 1);
    assert_true(dominance_resistance(0.5, 0.1, INFINITY) == 1);
}

static void finds_the_resistant_neighbours(void **state) {
    (void)state;
    static const double bw[] = {INFINITY, 0.12, 0.2, 0.03, 0.1, 0.14, 0.19, 0.3, 0.08, 0.12, 0.32};
    static const double fw[] = {0.2, 0.08, 0.3, 0.27, 0.2, 0.16, 0.11, 0.08, 0.32, 0.2, INFINITY};
    struct curve curve = sample_curve();
    assert_true(isinf(curve.segments[0].h_bw) && isinf(curve.segments[10].h_fw));
    for (size_t i = 0; i < curve.count; i++) {
        if (i > 0)
            NEAR(curve.segments[i].h_bw, bw[i], 1e-12);
        if (i < 10)
            NEAR(curve.segments[i].h_fw, fw[i], 1e-12);
    }
    curve_free(&curve);
}

static const double curve_values[] = {
    3.444751165135, 5.425507883013, 4.145852510353, -1.939896652980, 3.198964280920,  5.044951078240,
    5.685973514649, 6.675563117792, 6.508443336049, -0.188877076908, -1.492409517327, -1.530337612258,
    2.788172570702, 3.720843063446, 3.426808020417, 2.588562672965,  0.512555066058};

/* The curve ignores effects with R below 1e-5. */
static void gives_the_curve(void **state) {
    (void)state;
    struct curve curve = sample_curve();
    struct curve_cursor forward = {0}, backward = {0};
    enum { N = sizeof curve_values / sizeof *curve_values };
    for (int n = 1; n <= N; n++)
        NEAR(curve_at(&curve, 0.05 * n, &forward), curve_values[n - 1], 2e-4);
    for (int n = N; n >= 1; n--)
        NEAR(curve_at(&curve, 0.05 * n, &backward), curve_values[n - 1], 2e-4);
    assert_true(curve_at(&curve, -1, &forward) == 0);
    assert_true(curve_at(&curve, 0.9, &forward) == 0);
    assert_true(curve_at(&curve, 1e9, &forward) == 0);
    curve_free(&curve);
}

static void leaves_out_what_has_no_effect(void **state) {
    (void)state;
    struct curve curve = {0};
    struct curve_cursor cursor = {0};
    struct coefficients glide = V;
    glide.alpha = 0;
    curve_add(&curve, 1, &REST);
    curve_add(&curve, 2, &glide);
    curve_add(&curve, 1, &V); /* not after the last one */
    assert_int_equal(curve.count, 1);
    curve_link(&curve);
    assert_true(curve_at(&curve, 0.5, &cursor) == 0 && curve_at(&curve, 1.5, &cursor) == 0);
    curve_free(&curve);

    struct curve empty = {0};
    cursor = (struct curve_cursor){0};
    curve_link(&empty);
    assert_true(curve_at(&empty, 0.5, &cursor) == 0);
    curve_free(&empty);
}

static void bears_far_targets(void **state) {
    (void)state;
    struct curve curve = {0};
    struct curve_cursor cursor = {0};
    struct coefficients steep = P;
    steep.theta_bw = steep.theta_fw = 1e6;
    curve_add(&curve, 0, &steep);
    curve_add(&curve, 1e5, &steep);
    curve_link(&curve);
    double middle = curve_at(&curve, 5e4, &cursor);
    assert_true(isfinite(middle));
    NEAR(middle, -2, 0.1);
    curve_free(&curve);
}

/* Returns the segments evaluated per sample of a curve of n syllables. */
static double cost(size_t n, double k_of_vowels) {
    struct curve curve = {0};
    struct curve_cursor cursor = {0};
    struct coefficients vowel = V, weak = W;
    vowel.k = k_of_vowels;
    for (size_t i = 0; i < n; i++) {
        curve_add(&curve, 0.2 * (double)i, &weak);
        curve_add(&curve, 0.2 * (double)i + 0.1, &vowel);
    }
    curve_link(&curve);
    size_t samples = 0;
    for (double t = 0; t < 0.2 * (double)n; t += 0.04, samples++)
        curve_at(&curve, t, &cursor);
    curve_free(&curve);
    return (double)cursor.evaluated / (double)samples;
}

static void costs_the_same_for_any_length(void **state) {
    (void)state;
    NEAR(cost(10000, 1), cost(100, 1), 0.1);
    assert_true(cost(10000, 1) < 5);
    /* Even without resistance. */
    NEAR(cost(10000, 0.5), cost(1000, 0.5), 0.2);
    assert_true(cost(10000, 0.5) < 2 * DOMINANCE_REACH + 2);
}

/* (3.2) literally, over all segments. */
static double original(const struct curve *curve, double t) {
    double above = 0, below = 0;
    for (size_t i = 0; i < curve->count; i++) {
        const struct coefficients *c = &curve->segments[i].c;
        double tau = t - curve->segments[i].at, exponent = (c->c_bw + c->c_fw) / 2;
        double d = c->alpha * exp(-(tau < 0 ? c->theta_bw : c->theta_fw) * pow(fabs(tau), exponent));
        above += c->T * d;
        below += d;
    }
    return above / below;
}

static void knows_the_original_function(void **state) {
    (void)state;
    struct curve curve = sample_curve(), plain = {0};
    for (size_t i = 0; i < curve.count; i++)
        curve_add(&plain, curve.segments[i].at, &curve.segments[i].c);
    curve_link_original(&plain);
    struct curve_cursor cursor = {0};
    double most = 0;
    for (double t = 0.001; t < 0.9; t += 0.003) {
        NEAR(curve_at(&plain, t, &cursor), original(&curve, t), 0.02);
        most = fmax(most, fabs(original(&curve, t) - curve_at(&curve, t, &(struct curve_cursor){0})));
    }
    assert_true(most > 0.5); /* the curves differ */
    /* The bilabial in the middle misses its target, which is why the resistance exists. */
    assert_true(curve_at(&plain, 0.2, &cursor) > 0);
    NEAR(curve_at(&curve, 0.2, &cursor), P.T, 0.3);
    curve_free(&curve);
    curve_free(&plain);
}

/* Works with any length of silence between two targets. */
static void original_bears_long_gaps(void **state) {
    (void)state;
    struct curve curve = {0};
    curve_add(&curve, 0, &REST);
    curve_add(&curve, 100, &V);
    curve_link_original(&curve);
    for (double t = -1; t < 102; t += 0.5) {
        double value = curve_at(&curve, t, &(struct curve_cursor){0});
        assert_true(value >= -1e-9 && value <= V.T + 1e-9);
    }
    curve_free(&curve);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(follows_the_formulas),
        cmocka_unit_test(finds_the_resistant_neighbours),
        cmocka_unit_test(gives_the_curve),
        cmocka_unit_test(leaves_out_what_has_no_effect),
        cmocka_unit_test(bears_far_targets),
        cmocka_unit_test(costs_the_same_for_any_length),
        cmocka_unit_test(knows_the_original_function),
        cmocka_unit_test(original_bears_long_gaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
