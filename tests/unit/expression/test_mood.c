/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static int load(void **state) {
    struct error e;
    *state = expressions_load(SOURCE_ROOT "/models/expressions.json", &e);
    return *state ? 0 : -1;
}

static int unload(void **state) {
    expressions_free(*state);
    return 0;
}

static double share(const struct mood *mood, double t, const char *name) {
    struct mood_part parts[AFFECTS_MAX];
    size_t count = mood_at(mood, t, parts);
    for (size_t i = 0; i < count; i++)
        if (!strcmp(parts[i].expression->name, name))
            return parts[i].intensity;
    return 0;
}

static void set(struct mood *mood, const char *name, double intensity, double at, double ease) {
    struct error e;
    assert_int_equal(mood_set(mood, &name, &intensity, 1, at, ease, &e), 0);
}

static void begins_neutral(void **state) {
    struct mood *mood = mood_new(*state);
    struct mood_part parts[AFFECTS_MAX];
    assert_int_equal(mood_at(mood, 0, parts), 0);
    assert_int_equal(mood_at(mood, 1e9, parts), 0);
    mood_free(mood);
}

static void eases_and_holds(void **state) {
    struct mood *mood = mood_new(*state);
    set(mood, "joy", 0.8, 10, 0.5);
    assert_true(share(mood, 9, "joy") == 0);
    assert_true(fabs(share(mood, 10.25, "joy") - 0.4) < 1e-9);
    assert_true(share(mood, 10.5, "joy") == 0.8);
    assert_true(share(mood, 1e6, "joy") == 0.8);
    struct error e;
    assert_int_equal(mood_set(mood, NULL, NULL, 0, 20, 1, &e), 0);
    assert_true(share(mood, 21, "joy") == 0);
    mood_free(mood);
    mood = mood_new(*state);
    set(mood, "joy", 0.8, 10, 0);
    assert_true(share(mood, 9, "joy") == 0.8 && share(mood, 10, "joy") == 0.8);
    set(mood, "joy", 0, 11, 0);
    assert_true(share(mood, 11, "joy") == 0.8 && share(mood, 11.2, "joy") == 0);
    mood_free(mood);
}

static void mixes(void **state) {
    struct mood *mood = mood_new(*state);
    struct error e;
    const char *const names[] = {"happy", "anger", "joy", "fear"};
    const double some[] = {0.2, 0.3, 0.1, NAN}, much[] = {1, 1, 1, 5};
    assert_int_equal(mood_set(mood, names, some, 4, 0, 0.2, &e), 0);
    assert_true(fabs(share(mood, 5, "joy") - 0.3) < 1e-9); /* by alias */
    assert_true(fabs(share(mood, 5, "anger") - 0.3) < 1e-9);
    assert_true(share(mood, 5, "fear") == 0);
    /* intensities are scaled to a sum of 1 */
    assert_int_equal(mood_set(mood, names, much, 4, 10, 0.2, &e), 0);
    assert_true(fabs(share(mood, 15, "joy") - 0.5) < 1e-9);
    assert_true(fabs(share(mood, 15, "anger") + share(mood, 15, "fear") - 0.5) < 1e-9);
    mood_free(mood);
}

static void refuses_what_it_does_not_know(void **state) {
    struct mood *mood = mood_new(*state);
    struct error e = {0};
    const char *const names[] = {"joy", "hunger", "joy", "joy", "joy"};
    const double ones[] = {1, 1, 1, 1, 1};
    assert_int_equal(mood_set(mood, names, ones, 2, 0, 1, &e), -1);
    assert_string_equal(error_name(e.code), "unknown-expression");
    assert_string_equal(e.field, "mix.1.name");
    assert_int_equal(mood_set(mood, names, ones, 5, 0, 1, &e), -1);
    assert_string_equal(e.field, "mix");
    assert_true(share(mood, 5, "joy") == 0); /* unchanged */
    mood_free(mood);
}

/* Frequent changes, as when dragging on an emotion disc, keep value and slope continuous. */
static void never_jumps(void **state) {
    struct mood *mood = mood_new(*state);
    static const char *const names[] = {"joy", "anger", "sadness", "pride"};
    const double step = 0.001;
    double now[4] = {0}, before[4] = {0}, slope[4] = {0}, next = 1;
    uint32_t random = 7;
    for (double t = 0; t < 30; t += step) {
        if (t >= next) {
            random = random * 1664525 + 1013904223;
            set(mood, names[random >> 30], (double)(random >> 8 & 0xff) / 255, t,
                (double)(random >> 16 & 0xff) / 400);
            next = t + (double)(random >> 20 & 0xff) / 700;
        }
        for (int i = 0; i < 4; i++) {
            double value = share(mood, t, names[i]), moved = (value - now[i]) / step;
            assert_true(value >= 0 && value <= 1);
            assert_true(fabs(moved) <= 18); /* 1.5 / 0.1 s, plus the previous change */
            /* No more than what the sharpest turn bends in a step: the slope does not jump. At 0 and 1 it
             * may. */
            if (fmin(value, fmin(now[i], before[i])) > 0 && fmax(value, fmax(now[i], before[i])) < 1 &&
                fabs(moved - slope[i]) > 4)
                fail_msg("%s at %.3f: from %.1f to %.1f a second", names[i], t, slope[i], moved);
            before[i] = now[i];
            slope[i] = moved;
            now[i] = value;
        }
    }
    mood_free(mood);
}

/* Times slightly before the last change can be evaluated. */
static void remembers_a_little(void **state) {
    struct mood *mood = mood_new(*state);
    for (int i = 0; i < 10; i++)
        set(mood, "joy", i % 2, i, 0.5);
    assert_true(share(mood, 5.9, "joy") == 1);
    assert_true(share(mood, 6.9, "joy") == 0);
    set(mood, "joy", 0, 2, 0.5); /* back in time: clamped to the last change */
    assert_true(share(mood, 7.9, "joy") == 1);
    assert_true(share(mood, 10, "joy") == 0);
    mood_free(mood);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(begins_neutral), cmocka_unit_test(eases_and_holds),
        cmocka_unit_test(mixes),          cmocka_unit_test(refuses_what_it_does_not_know),
        cmocka_unit_test(never_jumps),    cmocka_unit_test(remembers_a_little),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
