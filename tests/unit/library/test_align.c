/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/align.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RATE = 16000, SYLLABLE = 3200, SYLLABLES = 12 };

/* Synthesises distinct words of one syllable: a buzz through two resonances with a soft start and end, 0.2 s
 * each at speed 1, with a pause of `pause` samples before word `before`. Returns the sound and its length. */
static int16_t *words(const int *order, double speed, double pitch, int before, size_t pause, size_t *size) {
    size_t length = (size_t)(SYLLABLE / speed);
    int16_t *pcm = calloc(SYLLABLES * length + pause + 1, sizeof *pcm);
    size_t at = 0;
    for (int w = 0; w < SYLLABLES; w++) {
        double low = 250 + 60 * order[w], high = 2600 - 150 * order[w], a1 = 0, a2 = 0, b1 = 0, b2 = 0,
               phase = 0;
        if (w == before)
            at += pause;
        for (size_t i = 0; i < length; i++) {
            double t = (double)i / (double)length, x = 0;
            phase += pitch / RATE;
            if (phase >= 1) {
                phase -= 1;
                x = 3000;
            }
            double shape = sin(3.14159 * t), glide = 1 + 0.25 * t;
            double y = x + 1.94 * cos(6.28318 * low * glide / RATE) * a1 - 0.94 * a2;
            double z = x + 1.9 * cos(6.28318 * high / RATE) * b1 - 0.9 * b2;
            a2 = a1;
            a1 = y;
            b2 = b1;
            b1 = z;
            pcm[at++] = (int16_t)fmax(-30000, fmin(30000, shape * (y + z)));
        }
    }
    *size = at;
    return pcm;
}

static const int forwards[] = {0, 5, 2, 7, 1, 6, 3, 0, 7, 4, 1, 5},
                 others[] = {7, 7, 0, 1, 4, 4, 6, 2, 2, 5, 3, 0};

static void starts(uint64_t *out, double speed) {
    for (int w = 0; w < SYLLABLES; w++)
        out[w] = (uint64_t)(w * (size_t)(SYLLABLE / speed));
}

/* Largest error of the starts of words, s. */
static double worst(const struct align_map *map, double speed, int before, size_t pause) {
    double error = 0;
    for (int w = 1; w < SYLLABLES; w++) {
        double truth = (double)(w * (size_t)(SYLLABLE / speed) + (w >= before ? pause : 0)) / RATE;
        error = fmax(error, fabs((double)align_time(map, (uint64_t)w * SYLLABLE) / RATE - truth));
    }
    return error;
}

static void try(double speed, double pitch, int before, size_t pause, bool open_end, double allowed) {
    struct align_map map;
    size_t a, b;
    uint64_t gaps[SYLLABLES];
    int16_t *recording = words(forwards, speed, pitch, before, pause, &a);
    int16_t *reference = words(forwards, 1, 120, SYLLABLES, 0, &b);
    starts(gaps, 1);
    struct align_sound x = {recording, a, RATE}, y = {reference, b, RATE};
    assert_int_equal(align_make(&map, &x, &y, &(struct align_options){gaps, SYLLABLES, open_end, NULL}), 0);
    assert_true(worst(&map, speed, before, pause) <= allowed);
    for (uint64_t t = 0, last = 0; t < b; t += 50) {
        uint64_t now = align_time(&map, t);
        assert_true(now >= last && now <= a);
        last = now;
    }
    align_free(&map);
    free(recording);
    free(reference);
}

static void the_same(void **state) {
    (void)state;
    try(1, 120, SYLLABLES, 0, false, 0.001);
}

static void slower_and_faster(void **state) {
    (void)state;
    try(0.7, 120, SYLLABLES, 0, false, 0.025);
    try(1.5, 120, SYLLABLES, 0, false, 0.025);
    try(0.8, 180, SYLLABLES, 0, false, 0.03);
}

/* A pause missing in the reference: words before and after it are still found. */
static void a_pause(void **state) {
    (void)state;
    for (int before = 0; before < SYLLABLES; before += 3)
        try(1, 140, before, RATE, false, 0.03);
}

static void other_words(void **state) {
    (void)state;
    struct align_map same, wrong;
    size_t a, b, c;
    uint64_t gaps[SYLLABLES];
    int16_t *mine = words(forwards, 0.9, 140, SYLLABLES, 0, &a),
            *reference = words(forwards, 1, 120, SYLLABLES, 0, &b),
            *foreign = words(others, 0.9, 140, SYLLABLES, 0, &c);
    starts(gaps, 1);
    struct align_sound x = {mine, a, RATE}, y = {reference, b, RATE}, z = {foreign, c, RATE};
    assert_int_equal(align_make(&same, &x, &y, &(struct align_options){gaps, SYLLABLES, false, NULL}), 0);
    assert_int_equal(align_make(&wrong, &z, &y, &(struct align_options){gaps, SYLLABLES, false, NULL}), 0);
    assert_true(wrong.distance > 1.3 * same.distance);
    align_free(&same);
    align_free(&wrong);
    free(mine);
    free(reference);
    free(foreign);
}

/* The recording continues with other words after the reference ends. */
static void open_end(void **state) {
    (void)state;
    struct align_map map;
    size_t a, b;
    uint64_t gaps[SYLLABLES];
    int16_t *recording = words(forwards, 1, 140, SYLLABLES, 0, &a),
            *reference = words(forwards, 1, 120, SYLLABLES, 0, &b);
    struct align_sound x = {recording, a, RATE}, y = {reference, (size_t)7 * SYLLABLE, RATE};
    starts(gaps, 1);
    assert_int_equal(align_make(&map, &x, &y, &(struct align_options){gaps, 7, true, NULL}), 0);
    double end = (double)align_time(&map, y.samples) / RATE, truth = 7.0 * SYLLABLE / RATE;
    assert_true(fabs(end - truth) < 0.05);
    align_free(&map);
    free(recording);
    free(reference);
}

static void far_too_short(void **state) {
    (void)state;
    struct align_map map;
    size_t a, b;
    int16_t *recording = words(forwards, 1, 140, SYLLABLES, 0, &a),
            *reference = words(forwards, 1, 120, SYLLABLES, 0, &b);
    struct align_sound x = {recording, a / 4, RATE}, y = {reference, b, RATE}, none = {recording, 0, RATE};
    assert_int_equal(align_make(&map, &x, &y, &(struct align_options){NULL, 0, false, NULL}), -1);
    align_free(&map);
    assert_int_equal(align_make(&map, &none, &y, &(struct align_options){NULL, 0, false, NULL}), -1);
    align_free(&map);
    /* silence, which gives no evidence, does no harm */
    memset(recording, 0, a * sizeof *recording);
    struct align_sound silence = {recording, a, RATE};
    align_make(&map, &silence, &silence, &(struct align_options){NULL, 0, false, NULL});
    align_free(&map);
    free(recording);
    free(reference);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same),    cmocka_unit_test(slower_and_faster), cmocka_unit_test(a_pause),
        cmocka_unit_test(other_words), cmocka_unit_test(open_end),          cmocka_unit_test(far_too_short),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
