/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hearing.h"
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

/* Counted in samples: a frame comes so long after the instant that it shows, the lookahead included. */
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
    struct hear_network *n = hear_network_load(SOURCE_ROOT "/models/hear/network.bin", &e);
    assert_non_null(n);
    struct speech_pack *pack = speech_pack_load(SOURCE_ROOT "/models/speech/it.json", &e);
    assert_non_null(pack);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct seen seen = {.rate = cases[i].rate};
        const struct hearing_options options = {.network = n,
                                                .pack = pack,
                                                .rate = cases[i].rate,
                                                .channels = 1,
                                                .lookahead = cases[i].lookahead,
                                                .fps = 25,
                                                .frame = see,
                                                .ctx = &seen};
        struct hearing *h = hearing_new(&options, &e);
        assert_non_null(h);
        for (; seen.written < 3 * seen.rate;) {
            float sample = (float)sin((double)seen.written / seen.rate * 1000);
            seen.written++;
            hearing_write(h, &sample, 1);
        }
        assert_in_range(seen.count, 50, 75);
        if (seen.latest > cases[i].most)
            fail_msg("%u Hz, %u ms: %.4f s", cases[i].rate, cases[i].lookahead, seen.latest);
        hearing_end(h);
        assert_int_equal(seen.count, 75);
        hearing_free(h);
    }
    struct hearing_options none = {.network = n, .pack = pack, .rate = 16000, .channels = 1, .lookahead = 41};
    assert_null(hearing_new(&none, &e));
    assert_int_equal(e.code, ERROR_BAD_FIELD);
    speech_pack_free(pack);
    hear_network_free(n);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_delay)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
