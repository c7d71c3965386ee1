/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions shared by the readers of sound: channels mixed to one, and WAV files whose recording was
 * interrupted. */
#include "server/base/sound/mixdown.h"
#include "server/base/sound/wav_file.h"
#include "server/library/align/sound/sound_file.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { RATE = 16000, FRAMES = 16000, MARGIN = 400 };

static double tone(size_t i, double hertz) {
    return 0.5 * sin(6.283185307 * hertz * (double)i / RATE);
}

/* Pseudo-random, -0.5 to 0.5. */
static double noise(uint32_t *state) {
    *state = *state * 1664525 + 1013904223;
    return (double)*state / 4294967296.0 - 0.5;
}

/* RMS of the mono mix of the frames made by `fill`, after the mixer has adapted. */
static double loudness(void (*fill)(float *frame, size_t i, uint32_t *state), unsigned channels) {
    struct mixdown m = {0};
    uint32_t state = 1;
    double sum = 0;
    float frame[MIXDOWN_CHANNELS_MAX];
    for (size_t i = 0; i < FRAMES; i++) {
        fill(frame, i, &state);
        double x = mixdown_frame(&m, frame, channels);
        sum += i >= MARGIN ? x * x : 0;
    }
    return sqrt(sum / (FRAMES - MARGIN));
}

static void fill_inverted(float *frame, size_t i, uint32_t *state) {
    (void)state;
    frame[0] = (float)tone(i, 200);
    frame[1] = -frame[0];
}

static void fill_weaker(float *frame, size_t i, uint32_t *state) {
    frame[0] = (float)tone(i, 200);
    frame[1] = (float)(-0.4 * tone(i, 200) + 0.02 * noise(state));
    frame[2] = (float)tone(i, 200);
}

/* The first channel is silent, and the third is the second inverted. */
static void fill_silent_first(float *frame, size_t i, uint32_t *state) {
    (void)state;
    frame[0] = 0;
    frame[1] = (float)tone(i, 300);
    frame[2] = -frame[1];
}

static void fill_apart(float *frame, size_t i, uint32_t *state) {
    (void)i;
    frame[0] = (float)noise(state);
    frame[1] = (float)noise(state);
}

static void inverted_channels_are_heard(void **state) {
    (void)state;
    const double one = 0.5 / sqrt(2);
    assert_true(fabs(loudness(fill_inverted, 2) - one) < 0.01);
    assert_true(loudness(fill_weaker, 3) > 0.75 * one);
    assert_true(fabs(loudness(fill_silent_first, 3) - one * 2 / 3) < 0.02);
}

/* Normal stereo is averaged; mono is unchanged. */
static void other_channels_are_the_mean(void **state) {
    (void)state;
    struct mixdown m = {0}, alone = {0};
    uint32_t random = 7;
    for (size_t i = 0; i < FRAMES; i++) {
        float frame[2];
        fill_apart(frame, i, &random);
        frame[1] += (float)tone(i, 150);
        assert_true(fabs(mixdown_frame(&m, frame, 2) - ((double)frame[0] + (double)frame[1]) / 2) < 1e-9);
        assert_true(fabs(mixdown_frame(&alone, frame, 1) - (double)frame[0]) < 1e-9);
    }
}

static void no_number_counts_as_silence(void **state) {
    (void)state;
    struct mixdown m = {0};
    const float bad[] = {NAN, INFINITY, -INFINITY, 1e30f};
    for (size_t i = 0; i < FRAMES; i++)
        assert_true(isfinite(mixdown_frame(&m, bad, 4)));
    float frame[2] = {0.25f, 0.25f};
    for (size_t i = 0; i < 10 * (size_t)FRAMES; i++)
        mixdown_frame(&m, frame, 2);
    assert_true(fabs(mixdown_frame(&m, frame, 2) - 0.25) < 1e-6);
}

static void put(uint8_t *at, uint32_t value, int bytes) {
    for (int i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

enum { HEAD = 44 + 34, SAMPLES = 4000, SIZE = HEAD + 2 * SAMPLES };

/* Makes a WAV file as ffmpeg writes it to a pipe (a LIST chunk before the sound), with these lengths. */
static void make(uint8_t *wav, uint32_t riff, uint32_t data) {
    memset(wav, 0, SIZE);
    memcpy(wav, "RIFF\0\0\0\0WAVEfmt ", 16);
    put(wav + 4, riff, 4);
    put(wav + 16, 16, 4);
    put(wav + 20, 1, 2);
    put(wav + 22, 1, 2);
    put(wav + 24, RATE, 4);
    put(wav + 28, 2 * RATE, 4);
    put(wav + 32, 2, 2);
    put(wav + 34, 16, 2);
    memcpy(wav + 36, "LIST", 4);
    put(wav + 40, 26, 4);
    memcpy(wav + 70, "data", 4);
    put(wav + 74, data, 4);
    for (size_t i = 0; i < SAMPLES; i++)
        put(wav + HEAD + 2 * i, (uint32_t)(int32_t)(i % 2000), 2);
}

static const char *write_file(const uint8_t *wav, size_t size) {
    static const char path[] = "test_sound.wav";
    FILE *file = fopen(path, "wb");
    assert_int_equal(fwrite(wav, 1, size, file), size);
    fclose(file);
    return path;
}

static void check_samples(const char *path, size_t from) {
    struct error e;
    char text[400];
    struct sound_file *sound = sound_open(path, &e);
    if (!sound)
        fail_msg("%s", error_text(&e, text, sizeof text));
    const struct sound_source *source = sound_source(sound);
    assert_int_equal(source->samples, SAMPLES);
    assert_int_equal(source->rate, RATE);
    int16_t pcm[SAMPLES + 10];
    assert_int_equal(source->read(source->ctx, from, pcm, SAMPLES + 10), SAMPLES - from);
    for (size_t i = 0; i < SAMPLES - from; i++)
        assert_int_equal(pcm[i], (from + i) % 2000);
    sound_close(sound);
}

static void a_recorder_that_died(void **state) {
    (void)state;
    static const uint32_t lengths[][2] = {
        {0, 0},  {0xFFFFFFFF, 0xFFFFFFFF}, {0, 0xFFFFFFFF},          {HEAD - 8, 0},          {8, 0},
        {36, 0}, {0xFFFFFFFF, 0},          {0x7FFFFFFF, 0x7FFFFFDB}, {SIZE - 8, 2 * SAMPLES}};
    uint8_t *wav = malloc(SIZE);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        make(wav, lengths[i][0], lengths[i][1]);
        const char *path = write_file(wav, SIZE);
        check_samples(path, 0);
        check_samples(path, 1234);
        wav_file_mend(wav, SIZE);
        SNDFILE *file = wav_file_open(path, &(SF_INFO){0});
        assert_non_null(file);
        sf_close(file);
        if (i < 7) {
            uint8_t well[SIZE];
            make(well, SIZE - 8, 2 * SAMPLES);
            assert_memory_equal(wav, well, SIZE);
        }
    }
    unlink("test_sound.wav");
    free(wav);
}

/* A file that declares no sound and has the declared length contains none: data after it is not sound. */
static void an_empty_file_stays_empty(void **state) {
    (void)state;
    uint8_t *wav = malloc(SIZE);
    struct error e = {0};
    make(wav, SIZE - 8, 0);
    memcpy(wav + HEAD, "LIST", 4);
    put(wav + HEAD + 4, SIZE - HEAD - 8, 4);
    assert_null(sound_open(write_file(wav, SIZE), &e));
    assert_int_equal(e.code, ERROR_BAD_SOUND);
    for (size_t size = 0; size < 100; size++) { /* truncated anywhere: no sound, no overrun */
        make(wav, 0, 0);
        uint8_t *part = malloc(size + 1);
        memcpy(part, wav, size);
        struct sound_file *sound = sound_open(write_file(part, size), &e);
        assert_true((sound != NULL) == (size >= HEAD + 2));
        sound_close(sound);
        wav_file_mend(part, size);
        free(part);
    }
    unlink("test_sound.wav");
    free(wav);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inverted_channels_are_heard), cmocka_unit_test(other_channels_are_the_mean),
        cmocka_unit_test(no_number_counts_as_silence), cmocka_unit_test(a_recorder_that_died),
        cmocka_unit_test(an_empty_file_stays_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
