/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The window over a long recording: bounded, without the middle of pauses, and every sample knows its place.
 */
#include "server/library/align/window.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { RATE = 8000 };

/* 2 s of tone and 8 s of near silence in a loop, generated on reading. */
struct made {
    uint64_t samples, read;
};

static bool sounds(uint64_t at) {
    return at / RATE % 10 < 2;
}

static int16_t sample(uint64_t at) {
    return (int16_t)(sounds(at) ? 8000 * sin((double)(at % 8000) * 0.3) : (int)(at * 7919 % 5));
}

static size_t read_made(void *ctx, uint64_t from, int16_t *out, size_t count) {
    struct made *m = ctx;
    size_t n = 0;
    for (; n < count && from + n < m->samples; n++)
        out[n] = sample(from + n);
    m->read += n;
    return n;
}

static void hours_in_little_memory(void **state) {
    (void)state;
    struct made made = {(uint64_t)RATE * 3600 * 3, 0};
    const struct sound_source source = {read_made, &made, RATE, made.samples};
    struct window w;
    size_t most = 0;
    uint64_t sounding = 0, last = 0;
    window_open(&w, &source);
    while (!w.ended || w.samples) {
        window_fill(&w, (size_t)20 * RATE);
        most = w.cap > most ? w.cap : most;
        size_t use = w.samples < (size_t)12 * RATE ? w.samples : (size_t)12 * RATE;
        for (size_t i = 0; i < use; i += 97) {
            uint64_t place = window_place(&w, i);
            assert_int_equal(w.pcm[i], sample(place));
            assert_true(place >= last && place < made.samples);
            last = place;
        }
        for (size_t i = 0; i < use; i++)
            sounding += sounds(window_place(&w, i));
        window_drop(&w, use);
    }
    assert_true(sounding == (uint64_t)RATE * 3600 * 3 / 5); /* no sound is lost */
    assert_true(most < (size_t)RATE * 45);
    assert_true(made.read < made.samples * 2);
    window_close(&w);
}

static void pauses_are_shortened(void **state) {
    (void)state;
    struct made made = {(uint64_t)RATE * 40, 0};
    const struct sound_source source = {read_made, &made, RATE, made.samples};
    struct window w;
    window_open(&w, &source);
    window_fill(&w, (size_t)1000 * RATE);
    assert_true(w.ended);
    /* four tones of 2 s, three pauses and one at the end */
    assert_in_range(w.samples, 8 * RATE + 4 * RATE * 9 / 10, 8 * RATE + 4 * RATE * 14 / 10);
    window_close(&w);
}

static void the_rest(void **state) {
    (void)state;
    struct made made = {(uint64_t)RATE * 40, 0};
    const struct sound_source source = {read_made, &made, RATE, made.samples};
    struct window w;
    window_open(&w, &source);
    assert_float_equal(window_sounds(&w, (uint64_t)RATE * 5, UINT64_MAX, 60), 6, 0.1);
    assert_float_equal(window_sounds(&w, (uint64_t)RATE * 5, UINT64_MAX, 1), 1, 0.1);
    assert_float_equal(window_sounds(&w, (uint64_t)RATE * 33, UINT64_MAX, 60), 0, 0.01);
    window_close(&w);
}

static void nothing_at_all(void **state) {
    (void)state;
    struct sound_memory memory = {NULL, 0};
    const struct sound_source source = sound_in_memory(&memory, RATE);
    struct window w;
    window_open(&w, &source);
    window_fill(&w, 1000);
    assert_true(w.ended);
    assert_int_equal(w.samples, 0);
    window_drop(&w, 10);
    assert_int_equal(window_place(&w, 0), 0);
    window_close(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hours_in_little_memory),
        cmocka_unit_test(pauses_are_shortened),
        cmocka_unit_test(the_rest),
        cmocka_unit_test(nothing_at_all),
    };
    return cmocka_run_group_tests_name("window", tests, NULL, NULL);
}
