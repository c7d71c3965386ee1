/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quality stage on sounds of any length: what it may never exceed, and what it leaves alone. */
#include "server/voice/voice_quality.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct score_quality most = {.tilt = QUALITY_TILT_MAX,
                                          .aspiration = 0.5,
                                          .jitter = QUALITY_JITTER_MAX,
                                          .shimmer = QUALITY_SHIMMER_MAX,
                                          .flutter = QUALITY_FLUTTER_MAX,
                                          .tremor = QUALITY_TREMOR_MAX};

enum { MOST_SAMPLES = 48000 };

/* A voice of 120 Hz: pulses through a resonance. */
static void voice(int16_t *pcm, uint32_t samples, uint32_t rate, double peak) {
    double a = 0, b = 0, phase = 0, highest = 1;
    double *x = calloc(samples + 1, sizeof *x);
    for (uint32_t i = 0; i < samples; i++) {
        phase += 120.0 / rate;
        double pulse = phase >= 1 ? 1 : 0;
        phase -= phase >= 1 ? 1 : 0;
        double y = pulse + 2 * 0.97 * cos(2 * M_PI * 700 / rate) * a - 0.97 * 0.97 * b;
        b = a;
        a = x[i] = y;
        highest = fmax(highest, fabs(y));
    }
    for (uint32_t i = 0; i < samples; i++)
        pcm[i] = (int16_t)lrint(x[i] / highest * peak);
    free(x);
}

static double rms(const int16_t *pcm, uint32_t from, uint32_t to) {
    double sum = 0;
    for (uint32_t i = from; i < to; i++)
        sum += (double)pcm[i] * pcm[i];
    return sqrt(sum / (to - from));
}

static int peak_of(const int16_t *pcm, uint32_t samples) {
    int peak = 0;
    for (uint32_t i = 0; i < samples; i++)
        peak = abs(pcm[i]) > peak ? abs(pcm[i]) : peak;
    return peak;
}

static void is_no_louder_at_any_length(void **state) {
    (void)state;
    static int16_t was[MOST_SAMPLES], is[MOST_SAMPLES];
    static const uint32_t lengths[] = {1, 2, 7, 79, 80, 400, 1999, 8000, MOST_SAMPLES},
                          rates[] = {8000, 16000, 22050, 48000};
    static const double peaks[] = {1, 3000, 32767};
    for (size_t n = 0; n < sizeof lengths / sizeof *lengths; n++)
        for (size_t r = 0; r < sizeof rates / sizeof *rates; r++)
            for (size_t p = 0; p < sizeof peaks / sizeof *peaks; p++) {
                uint32_t count = lengths[n];
                voice(was, count, rates[r], peaks[p]);
                memcpy(is, was, count * sizeof *is);
                voice_quality_apply(is, count, rates[r], 0, count, &most);
                int peak = peak_of(was, count);
                assert_true(peak_of(is, count) <= (peak > 29205 ? peak : 29205));
                assert_true(rms(is, 0, count) <= 1.01 * rms(was, 0, count) + 1);
            }
}

static void changes_only_the_stretch(void **state) {
    (void)state;
    static int16_t was[MOST_SAMPLES], is[MOST_SAMPLES];
    const uint32_t rate = 22050, from = 10000, to = 20000, ramp = rate / 50;
    voice(was, MOST_SAMPLES, rate, 20000);
    memcpy(is, was, sizeof is);
    voice_quality_apply(is, MOST_SAMPLES, rate, from, to, &most);
    assert_memory_equal(is, was, (from - ramp) * sizeof *is);
    assert_memory_equal(is + to + ramp, was + to + ramp, (MOST_SAMPLES - to - ramp) * sizeof *is);
    assert_memory_not_equal(is + from, was + from, (to - from) * sizeof *is);
    /* no step at the borders that the changed sound does not have */
    int border = 0, inside = 0;
    for (uint32_t i = from - ramp; i < to + ramp; i++) {
        int step = abs(is[i] - is[i - 1]), *most_of = i < from + ramp || i > to - ramp ? &border : &inside;
        *most_of = step > *most_of ? step : *most_of;
    }
    assert_true(border <= 1.2 * inside);
}

static void leaves_silence_and_a_modal_voice(void **state) {
    (void)state;
    static int16_t was[MOST_SAMPLES], is[MOST_SAMPLES];
    voice_quality_apply(is, MOST_SAMPLES, 22050, 0, MOST_SAMPLES, &most);
    assert_memory_equal(is, was, sizeof is);
    voice(was, MOST_SAMPLES, 22050, 20000);
    memcpy(is, was, sizeof is);
    voice_quality_apply(is, MOST_SAMPLES, 22050, 0, MOST_SAMPLES, &(struct score_quality){0});
    voice_quality_apply(is, MOST_SAMPLES, 22050, 5000, 5000, &most);
    voice_quality_apply(is, MOST_SAMPLES, 22050, MOST_SAMPLES, MOST_SAMPLES + 9, &most);
    voice_quality_apply(is, MOST_SAMPLES, 4000, 0, MOST_SAMPLES, &most); /* no voice has so few */
    assert_memory_equal(is, was, sizeof is);
}

static void is_the_same_each_time(void **state) {
    (void)state;
    static int16_t one[MOST_SAMPLES], other[MOST_SAMPLES];
    voice(one, MOST_SAMPLES, 22050, 20000);
    memcpy(other, one, sizeof other);
    voice_quality_apply(one, MOST_SAMPLES, 22050, 0, MOST_SAMPLES, &most);
    voice_quality_apply(other, MOST_SAMPLES, 22050, 0, MOST_SAMPLES, &most);
    assert_memory_equal(one, other, sizeof one);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_no_louder_at_any_length),
        cmocka_unit_test(changes_only_the_stretch),
        cmocka_unit_test(leaves_silence_and_a_modal_voice),
        cmocka_unit_test(is_the_same_each_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
