/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/jitter_buffer.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { RATE = 16000, BLOCK = 320 /* 20 ms */ };

struct run {
    double speed;       /* of the sender's clock, 1 = ours */
    unsigned late;      /* every n-th block arrives with the next */
    double took, worst; /* samples taken; maximum difference from the elapsed time, s */
    double ahead;       /* difference at the end, s */
    size_t out;         /* samples dropped */
};

/* Feeds seconds of a tone and takes everything available. */
static void go(struct jitter_buffer *p, struct run *run, double seconds) {
    int16_t block[BLOCK], taken[4 * BLOCK];
    double phase = 0;
    for (unsigned i = 1; i * 0.02 / run->speed < seconds; i++) {
        double now = (i + (run->late && i % run->late == 0 ? 1 : 0)) * 0.02 / run->speed;
        for (int k = 0; k < BLOCK; k++)
            block[k] = (int16_t)lrint(10000 * sin(phase += 0.2));
        run->out += jitter_buffer_add(p, block, BLOCK, now);
        run->took += (double)jitter_buffer_take(p, taken, 4 * BLOCK);
        run->ahead = run->took / RATE - now;
        if (now > 20)
            run->worst = fmax(run->worst, fabs(run->ahead));
    }
}

static void test_same_clock(void **state) {
    (void)state;
    struct jitter_buffer p;
    int16_t in[BLOCK], out[BLOCK];
    jitter_buffer_open(&p, RATE, 2 * RATE);
    for (int i = 0; i < 3000; i++) {
        for (int k = 0; k < BLOCK; k++)
            in[k] = (int16_t)rand();
        /* up to 15 ms late, at random */
        jitter_buffer_add(&p, in, BLOCK, i * 0.02 + rand() % 16 / 1000.0);
        assert_int_equal(jitter_buffer_take(&p, out, BLOCK), BLOCK);
        assert_memory_equal(in, out, sizeof in);
    }
    jitter_buffer_free(&p);
}

/* 3 % over a minute is 1.8 s; the backlog stays within 0.2 s. */
static void test_other_clock(void **state) {
    (void)state;
    static const double speeds[] = {1.03, 0.97, 1.01, 0.995};
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; i++)
        for (unsigned late = 0; late <= 7; late += 7) {
            struct jitter_buffer p;
            struct run run = {.speed = speeds[i], .late = late};
            jitter_buffer_open(&p, RATE, 2 * RATE);
            go(&p, &run, 120);
            assert_int_equal(run.out, 0);
            assert_true(fabs(p.speed - (speeds[i] - 1)) < 0.01);
            if (run.worst > 0.2)
                fail_msg("%g: %g s apart", speeds[i], run.worst);
            jitter_buffer_free(&p);
        }
}

/* Resampling restores the pitch: a tone from a clock 3 % fast comes out correctly, without clicks. */
static void test_tone(void **state) {
    (void)state;
    struct jitter_buffer p;
    int16_t in[BLOCK], out[2 * BLOCK];
    double phase = 0, error = 0;
    size_t crossings = 0, count = 0;
    int16_t last = 0;
    jitter_buffer_open(&p, RATE, 2 * RATE);
    p.speed = -0.03;
    for (int i = 0; i < 50; i++) {
        for (int k = 0; k < BLOCK; k++)
            in[k] = (int16_t)lrint(10000 * sin(phase += 0.2));
        jitter_buffer_add(&p, in, BLOCK, 0.001); /* within one window */
        size_t got = jitter_buffer_take(&p, out, 2 * BLOCK);
        for (size_t k = 0; k < got; k++, count++) {
            double right = 10000 * sin(0.2 * (1 + 0.97 * (double)count));
            error = fmax(error, fabs(out[k] - right));
            crossings += last < 0 && out[k] >= 0;
            last = out[k];
        }
    }
    assert_true(count > 16400 && count < 16500);
    assert_in_range(crossings, 0.97 * 0.2 / 6.2832 * 16450 - 2, 0.97 * 0.2 / 6.2832 * 16450 + 2);
    assert_true(error < 30);
    jitter_buffer_free(&p);
}

static void test_too_much(void **state) {
    (void)state;
    static int16_t second[RATE];
    int16_t out[RATE];
    struct jitter_buffer p;
    size_t left = 0;
    jitter_buffer_open(&p, RATE, 2 * RATE);
    for (int i = 0; i < 100; i++) {
        for (int k = 0; k < RATE; k++)
            second[k] = (int16_t)(i * 100 + k / 160);
        left += jitter_buffer_add(&p, second, RATE, i * 0.001);
        assert_true(p.count <= 2 * RATE && p.cap < 16 * RATE);
    }
    assert_true(left > 90 * RATE);
    jitter_buffer_catch_up(&p);
    assert_int_equal(jitter_buffer_take(&p, out, RATE), RATE / 5);
    assert_int_equal(out[RATE / 5 - 1], 9999); /* the newest */
    jitter_buffer_free(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_clock),
        cmocka_unit_test(test_other_clock),
        cmocka_unit_test(test_tone),
        cmocka_unit_test(test_too_much),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
