/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversion of FAPs to ARKit's shapes: correct solver, preserved closures, left-right symmetry. */
#include "server/codec/arkit_weights.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Reproducible random number, 0..1. */
static double dice(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 40) / (double)(1 << 24);
}

enum { ROWS = 9 };

struct problem {
    double a[ROWS][BOX_SQUARES_MAX], right[BOX_SQUARES_MAX];
};

static void make(struct box_squares *s, struct problem *p, size_t count, double ridge, uint64_t *state) {
    double b[ROWS];
    memset(s, 0, sizeof *s);
    s->count = count;
    for (int r = 0; r < ROWS; r++) {
        b[r] = 8 * dice(state) - 4;
        for (size_t i = 0; i < count; i++)
            p->a[r][i] = dice(state) < 0.5 ? 0 : 4 * dice(state) - 2;
    }
    for (size_t i = 0; i < count; i++) {
        s->most[i] = 0.2 + dice(state);
        p->right[i] = 0;
        for (int r = 0; r < ROWS; r++)
            p->right[i] += p->a[r][i] * b[r];
        for (size_t k = 0; k < count; k++) {
            s->gram[i][k] = i == k ? ridge : 0;
            for (int r = 0; r < ROWS; r++)
                s->gram[i][k] += p->a[r][i] * p->a[r][k];
        }
    }
}

static double cost(const struct box_squares *s, const double *right, const double *x) {
    double sum = 0;
    for (size_t i = 0; i < s->count; i++) {
        for (size_t k = 0; k < s->count; k++)
            sum += 0.5 * x[i] * s->gram[i][k] * x[k];
        sum -= right[i] * x[i];
    }
    return sum;
}

static void test_smallest(void **state) {
    uint64_t seed = 1;
    struct box_squares s;
    struct problem p;
    (void)state;
    for (int round = 0; round < 400; round++) {
        size_t count = 1 + (size_t)(dice(&seed) * BOX_SQUARES_MAX);
        make(&s, &p, count < BOX_SQUARES_MAX ? count : BOX_SQUARES_MAX, round % 2 ? 1e-3 : 0.1, &seed);
        box_squares_begin(&s);
        assert_true(box_squares_solve(&s, p.right) < 10 * s.count);
        assert_true(box_squares_violation(&s, p.right) < 1e-9);
        for (size_t i = 0; i < s.count; i++)
            assert_true(s.x[i] >= 0 && s.x[i] <= s.most[i]);
        /* no neighbouring solution is better */
        double best = cost(&s, p.right, s.x), x[BOX_SQUARES_MAX];
        for (int k = 0; k < 50; k++) {
            for (size_t i = 0; i < s.count; i++)
                x[i] = fmin(s.most[i], fmax(0, s.x[i] + 0.2 * (dice(&seed) - 0.5)));
            assert_true(cost(&s, p.right, x) >= best - 1e-9);
        }
    }
}

/* A step away from the solution violates the conditions. */
static void test_violation(void **state) {
    uint64_t seed = 5;
    struct box_squares s;
    struct problem p;
    (void)state;
    make(&s, &p, 6, 0.1, &seed);
    box_squares_begin(&s);
    box_squares_solve(&s, p.right);
    for (size_t i = 0; i < s.count; i++) {
        double was = s.x[i];
        s.x[i] = was > s.most[i] / 2 ? was - 0.1 * s.most[i] : was + 0.1 * s.most[i];
        assert_true(box_squares_violation(&s, p.right) > 1e-3);
        s.x[i] = was;
    }
}

static void test_from_anywhere(void **state) {
    uint64_t seed = 3;
    struct box_squares s;
    struct problem p, other;
    double first[BOX_SQUARES_MAX];
    (void)state;
    for (int round = 0; round < 50; round++) {
        make(&s, &p, 30, 1e-2, &seed);
        box_squares_begin(&s);
        box_squares_solve(&s, p.right);
        memcpy(first, s.x, sizeof first);
        for (size_t i = 0; i < 30; i++)
            other.right[i] = 8 * dice(&seed) - 4;
        box_squares_solve(&s, other.right);
        box_squares_solve(&s, p.right);
        for (size_t i = 0; i < 30; i++)
            assert_float_equal(s.x[i], first[i], 1e-8);
    }
}

static int shape(const char *name) {
    for (int i = 0; i < ARKIT_SHAPES; i++)
        if (!strcmp(arkit_table[i].name, name))
            return i;
    fail_msg("no shape %s", name);
    return -1;
}

/* Adds the shape's FAPs, scaled by weight, to the frame. */
static void add(struct fap_frame *f, const char *name, double weight) {
    const struct arkit_shape *s = &arkit_table[shape(name)];
    for (int n = 3; n <= FAP_COUNT; n++)
        fap_frame_set(f, n, f->value[n] + (int32_t)lround(weight * s->faps[n]));
}

static void test_definitions(void **state) {
    (void)state;
    const double closed[ARKIT_SHAPES] = {[ARKIT_JAW_OPEN] = 1, [ARKIT_MOUTH_CLOSE] = 1};
    for (int pair = 0; pair < 3; pair++)
        assert_float_equal(arkit_gap(closed, pair), 0, 1e-9);
    const double open[ARKIT_SHAPES] = {[ARKIT_JAW_OPEN] = 1};
    assert_true(arkit_gap(open, 0) > 800);
    for (int i = 0; i < ARKIT_SHAPES; i++) {
        const int32_t *f = arkit_table[i].faps;
        for (int n = 3; n <= FAP_COUNT; n++)
            if (f[n] < fap_table[n].min || f[n] > fap_table[n].max)
                fail_msg("%s: FAP %d goes too far", arkit_table[i].name, n);
        if (strncmp(arkit_table[i].name, "eyeBlink", 8) == 0)
            assert_int_equal(f[19] + f[20] + f[21] + f[22], 1024);
    }
}

static void test_each_comes_back(void **state) {
    struct arkit_solver *solver = arkit_solver_new();
    (void)state;
    for (int i = 0; i < ARKIT_SHAPES; i++)
        for (double w = 0.5; w <= 1; w += 0.5) {
            struct fap_frame f = {0};
            double weights[ARKIT_SHAPES];
            add(&f, arkit_table[i].name, w);
            if (i == ARKIT_MOUTH_CLOSE)
                add(&f, "jawOpen", w); /* mouthClose needs an open jaw */
            arkit_weights(solver, &f, weights);
            double wanted = i == ARKIT_TONGUE_OUT ? (w * 450 - 61) / (450 - 61) : w;
            if (fabs(weights[i] - wanted) > (arkit_table[i].rare ? 0.2 : 0.03))
                fail_msg("%s at %g comes back as %g", arkit_table[i].name, w, weights[i]);
            for (int k = 0; k < ARKIT_SHAPES; k++)
                if (k != i && weights[k] > 0.12 && !(i == ARKIT_MOUTH_CLOSE && k == ARKIT_JAW_OPEN))
                    fail_msg("%s at %g shows %s at %g", arkit_table[i].name, w, arkit_table[k].name,
                             weights[k]);
        }
    arkit_solver_free(solver);
}

/* Makes a face typical of speech and expressions, with open or touching lips. */
static struct fap_frame face(uint64_t *seed, bool closed) {
    struct fap_frame f = {0};
    for (int n = 3; n <= FAP_COUNT; n++) {
        double range = fap_table[n].unit == FAP_UNIT_AU ? 20000 : n >= 19 && n <= 22 ? 700 : 250;
        fap_frame_set(&f, n, fap_clamp(n, (int32_t)(range * (2 * dice(seed) - 1))));
    }
    static const int pairs[][2] = {{4, 5}, {8, 10}, {9, 11}};
    for (int i = 0; closed && i < 3; i++)
        f.value[pairs[i][1]] = -f.value[pairs[i][0]] + (int32_t)(10 * dice(seed));
    return f;
}

static void test_closures(void **state) {
    struct arkit_solver *solver = arkit_solver_new();
    uint64_t seed = 7;
    int moved = 0;
    (void)state;
    for (int i = 0; i < 2000; i++) {
        double w[ARKIT_SHAPES];
        struct fap_frame f = face(&seed, i % 2);
        arkit_weights(solver, &f, w);
        for (int k = 0; k < ARKIT_SHAPES; k++)
            assert_true(w[k] >= 0 && w[k] <= 1);
        assert_true(w[ARKIT_MOUTH_CLOSE] <= w[ARKIT_JAW_OPEN]);
        for (int pair = 0; pair < 3 && i % 2; pair++)
            assert_true(arkit_gap(w, pair) < 1e-6);
        moved += arkit_gap(w, 0) > 50;
        if (f.value[19] + f.value[21] >= 1024)
            assert_float_equal(w[ARKIT_EYE_BLINK_LEFT], 1, 1e-12);
        else if (f.value[19] < 0 && f.value[21] < 0)
            assert_true(w[ARKIT_EYE_BLINK_LEFT] < 0.1);
    }
    assert_true(moved > 200); /* open lips stay open */
    struct fap_frame shut = {0};
    fap_frame_set(&shut, 20, 700);
    fap_frame_set(&shut, 22, 324);
    double w[ARKIT_SHAPES];
    arkit_weights(solver, &shut, w);
    assert_float_equal(w[ARKIT_EYE_BLINK_RIGHT], 1, 1e-12);
    assert_true(w[ARKIT_EYE_BLINK_LEFT] < 1e-9);
    arkit_solver_free(solver);
}

static void test_neutral(void **state) {
    struct arkit_solver *solver = arkit_solver_new();
    struct fap_frame f = {0};
    double w[ARKIT_SHAPES];
    (void)state;
    arkit_weights(solver, &f, w);
    for (int i = 0; i < ARKIT_SHAPES; i++)
        assert_true(w[i] == 0);
    arkit_solver_free(solver);
}

/* Mirrors a frame: swaps sides and negates lateral FAPs. */
static struct fap_frame mirrored(const struct fap_frame *f) {
    struct fap_frame m = *f;
    static const int pairs[] = {6, 8, 10, 12, 19, 21, 23, 25, 31, 33, 35, 37, 39, 41, 53, 55, 57, 59, 61};
    static const int turned[] = {15, 23, 24, 43, 49, 50, 64};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        m.value[pairs[i]] = f->value[pairs[i] + 1];
        m.value[pairs[i] + 1] = f->value[pairs[i]];
    }
    for (size_t i = 0; i < sizeof turned / sizeof *turned; i++)
        m.value[turned[i]] = -m.value[turned[i]];
    return m;
}

static int other_side(int i) {
    char name[32];
    const char *left = strstr(arkit_table[i].name, "Left"), *right = strstr(arkit_table[i].name, "Right");
    if (!left && !right)
        return i;
    snprintf(name, sizeof name, "%.*s%s", (int)((left ? left : right) - arkit_table[i].name),
             arkit_table[i].name, left ? "Right" : "Left");
    return shape(name);
}

static void test_sides(void **state) {
    struct arkit_solver *one = arkit_solver_new(), *other = arkit_solver_new();
    uint64_t seed = 11;
    (void)state;
    for (int i = 0; i < 300; i++) {
        struct fap_frame f = face(&seed, i % 2), m = mirrored(&f);
        double a[ARKIT_SHAPES], b[ARKIT_SHAPES];
        arkit_weights(one, &f, a);
        arkit_weights(other, &m, b);
        for (int k = 0; k < ARKIT_SHAPES; k++)
            assert_float_equal(a[k], b[other_side(k)], 1e-7);
    }
    arkit_solver_free(one);
    arkit_solver_free(other);
}

static void test_any_order(void **state) {
    struct arkit_solver *long_one = arkit_solver_new();
    uint64_t seed = 13;
    (void)state;
    for (int i = 0; i < 300; i++) {
        struct arkit_solver *fresh = arkit_solver_new();
        struct fap_frame f = face(&seed, i % 3 == 0);
        double a[ARKIT_SHAPES], b[ARKIT_SHAPES];
        arkit_weights(long_one, &f, a);
        arkit_weights(fresh, &f, b);
        for (int k = 0; k < ARKIT_SHAPES; k++)
            assert_float_equal(a[k], b[k], 1e-7);
        arkit_solver_free(fresh);
    }
    arkit_solver_free(long_one);
}

static void test_turns(void **state) {
    struct fap_frame f = {0};
    (void)state;
    fap_frame_set(&f, 49, 50000);
    fap_frame_set(&f, 48, -10000);
    fap_frame_set(&f, 24, 20000);
    struct arkit_turns t = arkit_turns_of(&f);
    assert_float_equal(t.head_yaw, 0.5, 1e-12);
    assert_float_equal(t.head_pitch, -0.1, 1e-12);
    assert_float_equal(t.eye_yaw[1], 0.2, 1e-12);
    assert_true(t.eye_yaw[0] == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_smallest),        cmocka_unit_test(test_violation),
        cmocka_unit_test(test_from_anywhere),   cmocka_unit_test(test_definitions),
        cmocka_unit_test(test_each_comes_back), cmocka_unit_test(test_closures),
        cmocka_unit_test(test_neutral),         cmocka_unit_test(test_sides),
        cmocka_unit_test(test_any_order),       cmocka_unit_test(test_turns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
