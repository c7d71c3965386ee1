/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/coder_pool.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

/* Each level is cheaper than the previous one. */
static void order(void **state) {
    (void)state;
    for (int i = 1; i < CODEC_LOAD_LEVELS; i++)
        assert_true(codec_load_levels[i].cost < codec_load_levels[i - 1].cost);
}

/* Returns the level after `windows` windows with the load of that many speakers. */
static unsigned settle(unsigned level, double speakers, int windows, unsigned *changes) {
    for (int i = 0; i < windows; i++) {
        double busy = fmin(1, speakers * codec_load_levels[level].cost / 1000);
        unsigned next = codec_load_choose(level, busy, true);
        *changes += next != level;
        level = next;
    }
    return level;
}

/* For any number of speakers the level converges, from above and below, to one that is in time if there is
 * any; a sudden crowd is handled within a few windows. */
static void rests(void **state) {
    (void)state;
    const unsigned ends[] = {CODEC_LOAD_BEST, CODEC_LOAD_LEVELS - 1};
    for (int speakers = 1; speakers < 1000; speakers++)
        for (int e = 0; e < 2; e++) {
            unsigned moves = 0, more = 0, level = settle(ends[e], speakers, 6, &moves);
            assert_true(speakers * codec_load_levels[level].cost <= 800.001 ||
                        level == CODEC_LOAD_LEVELS - 1);
            /* no cheaper than necessary: the next better level would leave too little reserve */
            assert_true(!level || speakers * codec_load_levels[level - 1].cost >= 599.999);
            assert_int_equal(settle(level, speakers, 20, &more), level);
            assert_int_equal(more, 0);
        }
}

static void few_are_heard_best(void **state) {
    (void)state;
    unsigned changes = 0;
    assert_int_equal(settle(CODEC_LOAD_LEVELS - 1, 20, 10, &changes), CODEC_LOAD_BEST);
}

static void calm(void **state) {
    (void)state;
    assert_int_equal(codec_load_choose(3, 0.1, false), 3);
    assert_int_equal(codec_load_choose(3, 0.1, true), 2);
    assert_true(codec_load_choose(0, 0.9, false) > 0);
    assert_int_equal(codec_load_choose(CODEC_LOAD_BEST, 0, true), CODEC_LOAD_BEST);
    assert_int_equal(codec_load_choose(CODEC_LOAD_LEVELS - 1, 1, true), CODEC_LOAD_LEVELS - 1);
}

/* Without a loop to measure, the quality is the best. */
static void nobody_counts(void **state) {
    (void)state;
    assert_int_equal(codec_load_now(NULL), CODEC_LOAD_BEST);
}

/* The coders' utilisation decides; the loop's only if it shares processors with them. */
static void busy(void **state) {
    (void)state;
    assert_true(fabs(codec_load_busy(0.5, 0.3, 2) - 0.3) < 1e-9);
    assert_true(fabs(codec_load_busy(0.9, 0.3, 2) - 0.9) < 1e-9);
    assert_true(fabs(codec_load_busy(0.9, 0.1, 8) - 0.1) < 1e-9);
    assert_true(fabs(codec_load_busy(0.9, 0.95, 2) - 0.95) < 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(order), cmocka_unit_test(busy),
        cmocka_unit_test(rests), cmocka_unit_test(few_are_heard_best),
        cmocka_unit_test(calm),  cmocka_unit_test(nobody_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
