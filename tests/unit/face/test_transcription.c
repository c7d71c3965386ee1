/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/phone_segments.h"
#include "server/face/packs/context_table.h"
#include "server/face/packs/transcription.h"
#include "tests/unit/pack_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define PACKS SOURCE_ROOT "/models/speech/"

/* The printed part of the thesis's sample, "Não pode haver tréguas na guerra contra a malária.": the first
 * and last lines. */
static const char sample[] =
    "0: 680 ##\n1: 1048 nn\n2: 3464 'a~\n3: 5686 uu\n4: 8694 pp\n5: 10538 'OO\n"
    "6: 14922 dZ\n7: 17258 ii\n8: 18146 aa\n9: 19096 vv\n10: 20784 'ee\n11: 23782 rr\n"
    "31: 72064 mm\n32: 73692 aa\n33: 76562 ll\n34: 78538 'AA\n35: 83138 r^\n36: 84944 ii\n"
    "37: 86682 aa\n38: 89546 ##\n39: 95270\n";

static int load(void **state) {
    return pack_load(state, "pt-BR");
}

static void refuse_warnings(void *ctx, const char *message) {
    (void)ctx;
    fail_msg("%s", message);
}

static double seconds(const struct sentence_audio *u, uint32_t sample) {
    return (double)sample / u->sample_rate;
}

static void reads_the_printed_sample(void **state) {
    struct error e;
    struct sentence_audio *u = transcription_read(sample, strlen(sample), &transcription_wav, *state, &e);
    assert_non_null(u);
    assert_int_equal(u->phone_count, 20);
    assert_int_equal(u->sample_rate, 16000);
    assert_int_equal(u->phones[0].start, 0); /* silence from the first sample */
    assert_true(fabs(seconds(u, u->phones[1].start) - 0.031375) < 1e-9);
    assert_true(fabs(seconds(u, u->phones[18].start) - 2.7074375) < 1e-9);
    assert_true(fabs(seconds(u, u->phones[19].start) - 2.7969375) < 1e-9);
    assert_true(fabs(seconds(u, u->samples) - 2.9758125) < 1e-9);
    for (size_t i = 1; i < u->phone_count; i++)
        assert_int_equal(u->phones[i].start, u->phones[i - 1].end);
    assert_string_equal(u->phones[5].ipa, "ɔ");
    assert_string_equal(u->phones[5].sampa, "O");
    assert_string_equal(u->phones[5].symbol, "'OO");
    assert_int_equal(u->phones[5].stress, 2);
    assert_int_equal(u->phones[6].stress, 0);
    assert_string_equal(u->phones[0].ipa, "");
    assert_string_equal(u->phones[0].sampa, "_");
    assert_null(u->pcm);
    sentence_audio_free(u);
}

/* The visemes and contexts of the sample, from its symbols on. */
static void gives_the_visemes_of_the_sample(void **state) {
    static const char *const visemes[] = {"rest", "t2", "a", "ʊ", "p1", "ɔ", "t1", "ɪ", "ɐ", "f1", "e", "r1"};
    const struct speech_pack *pack = *state;
    const struct context_table *table = pack->visemes;
    static const char lines[] =
        "0: 680 ##\n1: 1048 nn\n2: 3464 'a~\n3: 5686 uu\n4: 8694 pp\n5: 10538 'OO\n"
        "6: 14922 dZ\n7: 17258 ii\n8: 18146 aa\n9: 19096 vv\n10: 20784 'ee\n11: 23782 rr\n"
        "12: 24900 tt\n13: 25900 r^\n14: 27000 'EE\n15: 30000\n";
    struct error e;
    struct sentence_audio *u = transcription_read(lines, strlen(lines), &transcription_wav, pack, &e);
    assert_non_null(u);
    struct phone_segments g;
    phone_segments_from(pack, u, refuse_warnings, NULL, &g);
    /* the initial silence is shorter than a pause, but kept because it is the first */
    assert_int_equal(g.count, 15);
    for (size_t i = 0; i < sizeof visemes / sizeof *visemes; i++) {
        size_t sounds[CONTEXT_WINDOW];
        for (size_t k = 0; k < CONTEXT_WINDOW; k++) {
            size_t at = i + k;
            sounds[k] = at < 2 ? (size_t)CONTEXT_SILENCE : context_sound(table, g.items[at - 2].phone);
        }
        assert_string_equal(table->common.shapes.items[context_shape(table, sounds)].name, visemes[i]);
    }
    phone_segments_free(&g);
    sentence_audio_free(u);
}

static void counts_in_any_sound(void **state) {
    static const char lines[] = "\r\n0: 1000 aa\r\n  1: 8920   ##  \r\n2: 9000";
    const struct transcription_sound stereo = {1000, 8000, 4};
    struct error e;
    struct sentence_audio *u = transcription_read(lines, strlen(lines), &stereo, *state, &e);
    assert_non_null(u);
    assert_int_equal(u->phone_count, 2);
    assert_int_equal(u->phones[0].end, 1980);
    assert_int_equal(u->samples, 2000);
    sentence_audio_free(u);
}

static void names_the_line_of_an_error(void **state) {
    static const struct {
        const char *text;
        size_t line;
    } broken[] = {{"", 0},
                  {"0: 680 ##\n1: 1048 nn\n", 2},        /* no end */
                  {"0: 680 ##\n1: 1048 qq\n2: 2000", 2}, /* unknown symbol */
                  {"0: 680 ##\n1: 1048 'qq\n2: 2000", 2},
                  {"0: 680 ##\n1: 500 nn\n2: 2000", 2}, /* decreasing offset */
                  {"0: 680 ##\n0: 1048 nn\n2: 2000", 2},
                  {"0: 12 ##\n1: 1048", 1}, /* inside the header */
                  {"0 680 ##\n1: 1048", 1},
                  {"zero: 680 ##\n", 1},
                  {"0: ##\n", 1},
                  {"0: -680 ##\n", 1},
                  {"0: 99999999999999999999999 ##\n", 1},
                  {"0: 680\n", 1},                       /* no symbol */
                  {"0: 680 ##\n1: 700\n2: 800 aa\n", 3}, /* data after the end */
                  {"0: 680 "
                   "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
                   "aaaaaaaaaaaaaaaaaa"
                   "aaaaaaaaaaaaaaaaaaaaa\n1: 700",
                   1}};
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        struct error e = {0};
        assert_null(
            transcription_read(broken[i].text, strlen(broken[i].text), &transcription_wav, *state, &e));
        assert_string_equal(error_name(e.code), "bad-transcription");
        assert_int_equal(e.place, PLACE_LINE);
        assert_int_equal(e.line, broken[i].line);
    }
    struct error e = {0};
    struct speech_pack *it = speech_pack_load(PACKS "it.json", &e);
    assert_null(transcription_read(sample, strlen(sample), &transcription_wav, it, &e));
    assert_string_equal(error_name(e.code), "unknown-engine");
    speech_pack_free(it);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_the_printed_sample),
        cmocka_unit_test(gives_the_visemes_of_the_sample),
        cmocka_unit_test(counts_in_any_sound),
        cmocka_unit_test(names_the_line_of_an_error),
    };
    return cmocka_run_group_tests(tests, load, pack_unload);
}
