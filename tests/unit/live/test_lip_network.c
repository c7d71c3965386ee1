/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/lip_features.h"
#include "server/live/lip_network.h"
#include "server/live/lip_recogniser.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define NETWORK SOURCE_ROOT "/models/hear/network.bin"
#define VECTORS SOURCE_ROOT "/tests/unit/hear-vectors.bin"

static uint8_t *read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    uint8_t *data = malloc(1 << 20);
    *size = fread(data, 1, 1 << 20, file);
    fclose(file);
    return data;
}

static struct lip_network *load(void) {
    struct error e;
    struct lip_network *n = lip_network_load(NETWORK, &e);
    if (!n)
        fail_msg("%s", e.message);
    return n;
}

/* Compares all outputs for a piece of training data with those of the training code. */
static void test_as_trained(void **state) {
    (void)state;
    size_t size, heads;
    uint8_t *data = read_file(VECTORS, &size);
    uint32_t counts[5];
    memcpy(counts, data, sizeof counts);
    assert_true(counts[0] >= 50);
    assert_int_equal(counts[1], LIP_FEATURES);
    assert_int_equal(counts[3], LIP_CLASSES);
    assert_int_equal(counts[4], PARAM_COUNT);
    size_t told = counts[3] + counts[4];
    assert_int_equal(size, sizeof counts + sizeof(float) * counts[0] * (counts[1] + counts[2] * told + 1));
    const float *frames = (const float *)(data + sizeof counts), *answers = frames + counts[0] * counts[1],
                *voices = answers + counts[0] * counts[2] * told;
    unsigned delays[LIP_HEADS_MOST];
    struct lip_network *n = load();
    heads = lip_network_delays(n, delays);
    assert_int_equal(heads, counts[2]);
    double worst = 0;
    for (size_t head = 0; head < heads; head++) {
        struct lip_state *s = lip_state_new(n);
        for (size_t k = 0; k < counts[0]; k++) {
            struct lip_answer answer;
            const float *theirs = answers + (k * heads + head) * told;
            lip_state_step(s, frames + k * LIP_FEATURES, head, &answer);
            for (int c = 0; c < LIP_CLASSES; c++)
                worst = fmax(worst, fabs((double)(answer.likely[c] - theirs[c])));
            worst = fmax(worst, fabs((double)(answer.voice - voices[k])) / 10);
            for (int p = 0; p < PARAM_COUNT; p++)
                worst = fmax(worst, fabs((double)(answer.mouth[p] - theirs[LIP_CLASSES + p])) / 10);
        }
        lip_state_free(s);
    }
    assert_true(worst < 1e-4);
    lip_network_free(n);
    free(data);
}

static void test_bad_networks(void **state) {
    (void)state;
    size_t size;
    uint8_t *data = read_file(NETWORK, &size);
    char path[] = "/tmp/faccia-network-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    const struct {
        size_t size, at;
        uint8_t byte;
    } cases[] =
        {
            {0, 0, 'F'},    {7, 0, 'F'},      {36, 0, 'F'},   {size - 1, 0, 'F'}, {size, 0, 'f'},
            {size, 8, 32},  {size, 12, 0},    {size, 12, 33}, {size, 17, 255},    {size, 23, 255},
            {size, 24, 13}, {size, 28, 8},    {size, 32, 0},  {size, 32, 9},      {size, 36, 101},
            {size, 40, 0},  {size, 55, 0x7F}, /* a row with infinity or NaN */
        };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct error e = {0};
        FILE *file = fopen(path, "wb");
        uint8_t kept = data[cases[i].at];
        data[cases[i].at] = cases[i].byte;
        assert_int_equal(fwrite(data, 1, cases[i].size, file), cases[i].size);
        fclose(file);
        data[cases[i].at] = kept;
        struct lip_network *n = lip_network_load(path, &e);
        if (n)
            fail_msg("case %zu is taken", i);
        assert_int_equal(e.code, ERROR_BAD_NETWORK);
        assert_true(*e.message);
    }
    struct error e;
    assert_null(lip_network_load("/nowhere", &e));
    remove(path);
    free(data);
}

struct kept_frames {
    float frames[600][LIP_FEATURES];
    size_t count;
};

static void keep_frame(void *ctx, const float frame[LIP_FEATURES]) {
    struct kept_frames *k = ctx;
    assert_true(k->count < 600);
    memcpy(k->frames[k->count++], frame, sizeof k->frames[0]);
}

/* A tone appears in its own band, in proportion to its level, and not in distant ones; after normalisation
 * its loudness does not matter. */
static void test_tone(void **state) {
    (void)state;
    const double mel_low = 2595 * log10(1 + 100 / 700.0), mel_high = 2595 * log10(1 + 7000 / 700.0);
    static struct kept_frames loud, soft;
    for (double hz = 300; hz < 6000; hz *= 1.7) {
        static float tone[16000], softer[16000];
        for (int i = 0; i < 16000; i++) {
            tone[i] = (float)(0.5 * sin(6.283185307 * hz * i / LIP_RATE));
            softer[i] = tone[i] / 8;
        }
        loud.count = soft.count = 0;
        struct lip_features *a = lip_features_new(keep_frame, &loud),
                            *b = lip_features_new(keep_frame, &soft);
        lip_features_write(a, tone, 16000);
        lip_features_write(b, softer, 16000);
        lip_features_free(a);
        lip_features_free(b);
        assert_int_equal(loud.count, (16000 - LIP_WINDOW) / LIP_HOP + 1);
        double band = (2595 * log10(1 + hz / 700) - mel_low) / ((mel_high - mel_low) / (LIP_BANDS + 1)) - 1;
        size_t most = 0;
        for (size_t i = 0; i < LIP_BANDS; i++)
            if (loud.frames[0][i] > loud.frames[0][most])
                most = i;
        /* the initial mean emphasises the lowest bands, so high tones stand out */
        assert_true(fabs((double)most - band) < 3);
        for (size_t i = 0; i < LIP_FEATURES; i++)
            assert_true(fabs((double)loud.frames[50][i] - soft.frames[50][i]) < 0.35);
    }
}

struct kept_sound {
    float samples[40000];
    size_t count;
};

static void keep_sound(void *ctx, const float *samples, size_t count) {
    struct kept_sound *k = ctx;
    assert_true(count <= LIP_RATE / 50 && k->count + count <= 40000);
    memcpy(k->samples + k->count, samples, count * sizeof *samples);
    k->count += count;
}

/* At any rate, mono or with eight channels, in any pieces: a tone of 440 Hz is the same tone, its mean gone.
 */
static void test_rates(void **state) {
    (void)state;
    static const unsigned rates[] = {8000, 11025, 16000, 22050, 44100, 48000, 96000};
    static struct kept_sound whole, pieces;
    struct error e;
    for (size_t r = 0; r < sizeof rates / sizeof *rates; r++)
        for (unsigned channels = 1; channels <= 8; channels += 7) {
            unsigned rate = rates[r];
            float *sound = malloc(sizeof *sound * rate * channels);
            for (size_t i = 0; i < rate; i++)
                for (unsigned c = 0; c < channels; c++)
                    sound[i * channels + c] = (float)(0.2 + 0.3 * sin(6.283185307 * 440 * (double)i / rate));
            whole.count = pieces.count = 0;
            struct lip_input *a = lip_input_new(rate, channels, keep_sound, &whole, &e);
            struct lip_input *b = lip_input_new(rate, channels, keep_sound, &pieces, &e);
            lip_input_write(a, sound, rate);
            lip_input_end(a);
            for (size_t at = 0, n = 1; at < rate; at += n, n = 1 + (at * 7919) % 1500) {
                n = n < rate - at ? n : rate - at;
                lip_input_write(b, sound + at * channels, n);
            }
            lip_input_end(b);
            assert_int_equal(whole.count, pieces.count);
            assert_memory_equal(whole.samples, pieces.samples, whole.count * sizeof(float));
            assert_in_range(whole.count, LIP_RATE - 2, LIP_RATE + 2);
            double mean = 0, square = 0;
            for (size_t i = 4000; i < 12000; i++) {
                mean += whole.samples[i] / 8000;
                square += whole.samples[i] * whole.samples[i] / 8000;
            }
            assert_true(fabs(mean) < 0.002);
            assert_true(fabs(sqrt(square) - 0.3 / sqrt(2)) < 0.01);
            lip_input_free(a);
            lip_input_free(b);
            free(sound);
        }
    assert_null(lip_input_new(7999, 1, keep_sound, NULL, &e));
    assert_null(lip_input_new(96001, 1, keep_sound, NULL, &e));
    assert_null(lip_input_new(16000, 0, keep_sound, NULL, &e));
    assert_null(lip_input_new(16000, 9, keep_sound, NULL, &e));
    assert_int_equal(e.code, ERROR_BAD_SOUND);
}

static void likely_is(float likely[LIP_CLASSES], enum lip_class class, float how) {
    for (int i = 0; i < LIP_CLASSES; i++)
        likely[i] = (1 - how) / (LIP_CLASSES - 1);
    likely[class] = how;
}

/* Checks that the probabilities of all classes add up to 1. */
static void assert_likely(const struct lip_phone *phone) {
    double sum = 0;
    for (int i = 0; i < LIP_CLASSES; i++)
        sum += phone->likely[i];
    assert_true(fabs(sum - (phone->end - phone->start)) < 1e-4);
    assert_true(phone->likely[phone->class] > 0);
}

/* A closure begins at once and is held for its minimum time and while it is likely; a single uncertain frame
 * does not make a vowel. Sounds are adjacent. */
static void test_decoder(void **state) {
    (void)state;
    static const struct {
        enum lip_class class;
        float how;
        int frames;
    } said[] = {{LIP_SILENCE, 0.9F, 5}, {LIP_OPEN, 0.5F, 6},   {LIP_CLOSE, 0.5F, 1},  {LIP_OPEN, 0.5F, 4},
                {LIP_CLOSED, 0.4F, 1},  {LIP_MIDDLE, 0.9F, 6}, {LIP_CLOSED, 0.6F, 8}, {LIP_OPEN, 0.9F, 5}};
    static const struct lip_phone wanted[] = {{.class = LIP_SILENCE, .start = 0, .end = 5},
                                              {.class = LIP_OPEN, .start = 5, .end = 16},
                                              {.class = LIP_CLOSED, .start = 16, .end = 20},
                                              {.class = LIP_MIDDLE, .start = 20, .end = 23},
                                              {.class = LIP_CLOSED, .start = 23, .end = 31}};
    struct lip_decoder d;
    struct lip_phone ended;
    size_t count = 0;
    lip_decoder_begin(&d);
    for (size_t i = 0; i < sizeof said / sizeof *said; i++)
        for (int k = 0; k < said[i].frames; k++) {
            float likely[LIP_CLASSES];
            likely_is(likely, said[i].class, said[i].how);
            if (!lip_decoder_step(&d, likely, &ended))
                continue;
            assert_true(count < sizeof wanted / sizeof *wanted);
            assert_int_equal(ended.class, wanted[count].class);
            assert_int_equal(ended.start, wanted[count].start);
            assert_int_equal(ended.end, wanted[count].end);
            assert_likely(&ended);
            count++;
        }
    assert_int_equal(count, sizeof wanted / sizeof *wanted);
    assert_int_equal(d.now.class, LIP_OPEN);
    assert_int_equal(d.now.end, 36);
}

/* In doubt, decides for a closure or a labiodental contact. */
static void test_doubt(void **state) {
    (void)state;
    const float teeth[LIP_CLASSES] = {[LIP_TEETH] = 0.35F, [LIP_BACK] = 0.65F},
                no_teeth[LIP_CLASSES] = {[LIP_TEETH] = 0.3F, [LIP_BACK] = 0.7F};
    const float likely[LIP_CLASSES] = {[LIP_CLOSED] = 0.45F, [LIP_BACK] = 0.55F},
                less[LIP_CLASSES] = {[LIP_CLOSED] = 0.35F, [LIP_BACK] = 0.65F};
    struct lip_decoder d;
    struct lip_phone ended;
    lip_decoder_begin(&d);
    for (int k = 0; k < 3; k++)
        lip_decoder_step(&d, less, &ended);
    assert_int_equal(d.now.class, LIP_BACK);
    lip_decoder_step(&d, likely, &ended);
    assert_int_equal(d.now.class, LIP_CLOSED);
    lip_decoder_begin(&d);
    for (int k = 0; k < 3; k++)
        lip_decoder_step(&d, no_teeth, &ended);
    assert_int_equal(d.now.class, LIP_BACK);
    lip_decoder_step(&d, teeth, &ended);
    assert_int_equal(d.now.class, LIP_TEETH);
}

static int frames_until(struct lip_voice *v, float odds, float silence, bool none) {
    for (int k = 1; k < 1000; k++) {
        lip_voice_step(v, odds, silence);
        if (v->none == none)
            return k;
    }
    return 0;
}

/* The detector starts assuming speech; brief doubt, silence and NaN do not change its state; it switches to
 * speech faster than to music. */
static void test_voice(void **state) {
    (void)state;
    struct lip_voice v;
    lip_voice_begin(&v);
    for (int k = 0; k < 1000; k++)
        lip_voice_step(&v, k % 2 ? -1.5F : 2, 0);
    assert_false(v.none);
    for (int k = 0; k < 1000; k++)
        lip_voice_step(&v, -9, 1);
    assert_false(v.none);
    for (int k = 0; k < 1000; k++)
        lip_voice_step(&v, NAN, 0);
    assert_false(v.none);
    int falls = frames_until(&v, -3, 0, true);
    for (int k = 0; k < 1000; k++)
        lip_voice_step(&v, -9, 0);
    assert_true(v.none);
    int rises = frames_until(&v, 3, 0, false);
    assert_in_range(falls, 10, 80);
    assert_in_range(rises, 2, falls - 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_as_trained), cmocka_unit_test(test_bad_networks), cmocka_unit_test(test_tone),
        cmocka_unit_test(test_rates),      cmocka_unit_test(test_decoder),      cmocka_unit_test(test_doubt),
        cmocka_unit_test(test_voice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
