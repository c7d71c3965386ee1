/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/listening/stimuli_set.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SAMPLES = 20000, FROM = 8000, TO = 16000 };

/* A loud carrier, then a softer segment, then silence. */
static void speak(int16_t *speech) {
    for (int i = 0; i < SAMPLES; i++)
        speech[i] = (int16_t)(i < FROM ? 12000 * sin(i * 0.21) : i < TO ? 3000 * sin(i * 0.13) : 0);
}

static void ratios(void **state) {
    (void)state;
    static int16_t speech[SAMPLES], out[SAMPLES];
    speak(speech);
    for (double snr = -24; snr <= 12; snr += 6) {
        double scale = noise_mix(speech, SAMPLES, FROM, TO, snr, 1, out), power = 0, noise = 0, peak = 0;
        assert_true(scale > 0);
        for (int i = 0; i < SAMPLES; i++) {
            double n = out[i] / scale - speech[i];
            peak = fmax(peak, fabs((double)out[i]));
            power += i >= FROM && i < TO ? (double)speech[i] * speech[i] : 0;
            noise += i >= FROM && i < TO ? n * n : 0;
        }
        assert_float_equal(10 * log10(power / noise), snr, 0.01);
        assert_float_equal(peak, INT16_MAX, 1);
    }
}

static void uniform_and_white(void **state) {
    (void)state;
    static int16_t speech[SAMPLES], out[SAMPLES];
    int bins[10] = {0};
    double next = 0, square = 0, largest = 0;
    speech[0] = 1; /* the segment; all else is silence, so only noise remains */
    assert_true(noise_mix(speech, SAMPLES, 0, SAMPLES, -60, 5, out) > 0);
    for (int i = 0; i < SAMPLES; i++)
        largest = fmax(largest, fabs((double)out[i]));
    for (int i = 0; i < SAMPLES; i++) {
        int bin = (int)((out[i] / largest + 1) * 5);
        bins[bin > 9 ? 9 : bin]++;
        next += i ? (double)out[i] * out[i - 1] : 0;
        square += (double)out[i] * out[i];
    }
    for (int i = 0; i < 10; i++)
        assert_in_range(bins[i], SAMPLES / 10 * 9 / 10, SAMPLES / 10 * 11 / 10);
    assert_true(fabs(next / square) < 0.03);
    assert_float_equal(square / SAMPLES / (largest * largest), 1.0 / 3, 0.01);
}

static void seeds(void **state) {
    (void)state;
    static int16_t speech[SAMPLES], a[SAMPLES], b[SAMPLES];
    speak(speech);
    noise_mix(speech, SAMPLES, FROM, TO, -12, 7, a);
    noise_mix(speech, SAMPLES, FROM, TO, -12, 7, b);
    assert_memory_equal(a, b, sizeof a);
    noise_mix(speech, SAMPLES, FROM, TO, -12, 8, b);
    assert_memory_not_equal(a, b, sizeof a);
}

static void nothing(void **state) {
    (void)state;
    static int16_t speech[SAMPLES], out[SAMPLES], silence[SAMPLES];
    speak(speech);
    assert_true(noise_mix(speech, SAMPLES, TO, SAMPLES, -12, 1, out) == 0);
    assert_memory_equal(out, silence, sizeof out);
    assert_true(noise_mix(speech, SAMPLES, FROM, FROM, -12, 1, out) == 0);
    assert_true(noise_mix(speech, 0, 0, 0, -12, 1, out) == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ratios),
        cmocka_unit_test(uniform_and_white),
        cmocka_unit_test(seeds),
        cmocka_unit_test(nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
