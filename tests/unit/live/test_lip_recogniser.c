/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/lip_recogniser.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

struct seen {
    uint64_t written; /* samples */
    unsigned rate;
    uint32_t count;
    double latest; /* s */
};

static void see(void *ctx, uint32_t k, const struct fap_frame *frame) {
    struct seen *s = ctx;
    (void)frame;
    assert_int_equal(k, s->count);
    s->count++;
    s->latest = fmax(s->latest, (double)s->written / s->rate - k / 25.0);
}

/* Delay of a frame after the instant it shows, in samples, including the lookahead. */
static void test_delay(void **state) {
    (void)state;
    static const struct {
        unsigned rate, lookahead;
        double most; /* s */
    } cases[] = {{16000, 0, 0.0301},
                 {16000, 80, 0.1101},
                 {16000, 120, 0.1501},
                 {8000, 80, 0.145},
                 {48000, 120, 0.165}};
    struct error e;
    struct lip_network *n = lip_network_load(SOURCE_ROOT "/models/hear/network.bin", &e);
    assert_non_null(n);
    struct speech_pack *pack = speech_pack_load(SOURCE_ROOT "/models/speech/it.json", &e);
    assert_non_null(pack);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct seen seen = {.rate = cases[i].rate};
        const struct lip_recogniser_options options = {.network = n,
                                                       .pack = pack,
                                                       .rate = cases[i].rate,
                                                       .channels = 1,
                                                       .lookahead = cases[i].lookahead,
                                                       .fps = 25,
                                                       .frame = see,
                                                       .ctx = &seen};
        struct lip_recogniser *h = lip_recogniser_new(&options, &e);
        assert_non_null(h);
        for (; seen.written < 3 * seen.rate;) {
            float sample = (float)sin((double)seen.written / seen.rate * 1000);
            seen.written++;
            lip_recogniser_write(h, &sample, 1);
        }
        assert_in_range(seen.count, 50, 75);
        if (seen.latest > cases[i].most)
            fail_msg("%u Hz, %u ms: %.4f s", cases[i].rate, cases[i].lookahead, seen.latest);
        lip_recogniser_end(h);
        assert_int_equal(seen.count, 75);
        lip_recogniser_free(h);
    }
    struct lip_recogniser_options none = {
        .network = n, .pack = pack, .rate = 16000, .channels = 1, .lookahead = 41};
    assert_null(lip_recogniser_new(&none, &e));
    assert_int_equal(e.code, ERROR_BAD_FIELD);
    speech_pack_free(pack);
    lip_network_free(n);
}

static void keep(void *ctx, uint32_t k, const struct fap_frame *frame) {
    if (k < 250)
        ((struct fap_frame *)ctx)[k] = *frame;
}

/* The mouth is identical with and without movements of brows, eyes and head. */
static void test_mouth(void **state) {
    static struct fap_frame frames[2][250];
    (void)state;
    struct error e;
    struct lip_network *n = lip_network_load(SOURCE_ROOT "/models/hear/network.bin", &e);
    struct speech_pack *pack = speech_pack_load(SOURCE_ROOT "/models/speech/it.json", &e);
    for (int lives = 0; lives < 2; lives++) {
        const struct lip_recogniser_options options = {.network = n,
                                                       .pack = pack,
                                                       .rate = 16000,
                                                       .channels = 1,
                                                       .lookahead = 80,
                                                       .fps = 25,
                                                       .lives = lives,
                                                       .frame = keep,
                                                       .ctx = frames[lives]};
        struct lip_recogniser *h = lip_recogniser_new(&options, &e);
        assert_non_null(h);
        for (int i = 0; i < 160000; i++) {
            double t = i / 16000.0, beat = fmod(t, 0.22), loud = fmod(t, 3) < 2 ? sin(M_PI * beat / 0.22) : 0;
            float sample = (float)((0.1 + 0.1 * (fmod(t, 1.1) < 0.22)) * loud *
                                   (sin(t * 800) + sin(t * 1600) + sin(t * 6000 * (1 + beat))));
            lip_recogniser_write(h, &sample, 1);
        }
        lip_recogniser_end(h);
        lip_recogniser_free(h);
    }
    int moved = 0, opened = 0;
    for (int k = 0; k < 250; k++)
        for (int fap = 3; fap <= FAP_COUNT; fap++) {
            bool lives = (fap >= 19 && fap <= 26) || (fap >= 31 && fap <= 36) || (fap >= 48 && fap <= 50);
            if (!lives)
                assert_int_equal(frames[0][k].value[fap], frames[1][k].value[fap]);
            opened += !lives && frames[1][k].value[fap];
            moved += lives && frames[1][k].value[fap];
        }
    assert_true(opened > 250 && moved > 250);
    speech_pack_free(pack);
    lip_network_free(n);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_delay), cmocka_unit_test(test_mouth)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
