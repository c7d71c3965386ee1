/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converting, cutting and joining sentence audio: times stay with their sounds, without clicks or
 * gaps. */
#include "server/base/mem.h"
#include "server/voice/sentence_audio.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <cmocka.h>

/* A quarter second of silence, half a second of tone as a word of one phone, a quarter second of silence; a
 * mark at the start of the tone. */
static struct sentence_audio *word(uint32_t rate, double hertz, const char *ipa) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    u->sample_rate = rate;
    u->samples = rate;
    u->pcm = mem_alloc(rate * sizeof *u->pcm);
    for (uint32_t i = rate / 4; i < rate / 4 * 3; i++)
        u->pcm[i] = (int16_t)(8000 * cos(2 * M_PI * hertz * i / rate));
    u->phones = mem_alloc(3 * sizeof *u->phones);
    u->phones[0] = (struct phone){.sampa = "_", .start = 0, .end = rate / 4};
    u->phones[1] = (struct phone){.start = rate / 4, .end = rate / 4 * 3};
    strcpy(u->phones[1].ipa, ipa);
    u->phones[2] = (struct phone){.sampa = "_", .start = rate / 4 * 3, .end = rate};
    u->phone_count = 3;
    u->words = mem_alloc(sizeof *u->words);
    u->words[u->word_count++] =
        (struct word){.start = rate / 4, .end = rate / 4 * 3, .to = 1, .text = mem_strdup(ipa)};
    u->marks = mem_alloc(sizeof *u->marks);
    u->marks[u->mark_count++] = (struct mark){mem_strdup(ipa), rate / 4};
    strcpy(u->lang, ipa);
    return u;
}

static double loudness(const struct sentence_audio *u, double from, double to) {
    double sum = 0;
    uint32_t a = (uint32_t)(from * u->sample_rate), b = (uint32_t)(to * u->sample_rate);
    for (uint32_t i = a; i < b; i++)
        sum += (double)u->pcm[i] * u->pcm[i];
    return sqrt(sum / (b - a));
}

static int largest_step(const struct sentence_audio *u) {
    int largest = 0;
    for (uint32_t i = 1; i < u->samples; i++)
        if (abs(u->pcm[i] - u->pcm[i - 1]) > largest)
            largest = abs(u->pcm[i] - u->pcm[i - 1]);
    return largest;
}

static void check_phones(const struct sentence_audio *u) {
    uint32_t at = 0;
    for (size_t i = 0; i < u->phone_count; i++) {
        assert_int_equal(u->phones[i].start, at);
        assert_true(u->phones[i].end > at);
        at = u->phones[i].end;
    }
    assert_int_equal(at, u->samples);
}

static void another_rate(void **state) {
    (void)state;
    static const uint32_t rates[] = {8000, 16000, 22050, 32000, 44100, 48000};
    for (size_t i = 0; i < 6; i++)
        for (size_t k = 0; k < 6; k++) {
            struct sentence_audio *u = word(rates[i], 200, "a");
            sentence_audio_resample(u, rates[k]);
            assert_int_equal(u->sample_rate, rates[k]);
            assert_int_equal(u->samples, rates[k]);
            check_phones(u);
            assert_int_equal(u->words->start, (rates[i] / 4 * (uint64_t)rates[k] + rates[i] / 2) / rates[i]);
            assert_int_equal(u->marks->at, u->words->start);
            assert_float_equal(loudness(u, 0.3, 0.7), 8000 / sqrt(2), 60);
            assert_true(loudness(u, 0, 0.24) < 10 && loudness(u, 0.76, 1) < 10);
            sentence_audio_free(u);
        }
}

static void cutting(void **state) {
    (void)state;
    struct sentence_audio *u = word(10000, 200, "a");
    sentence_audio_cut(u, 3000, 7000); /* inside the tone */
    assert_int_equal(u->samples, 4000);
    check_phones(u);
    assert_int_equal(u->phone_count, 1);
    assert_int_equal(u->words->start, 0);
    assert_int_equal(u->words->end, 4000);
    assert_int_equal(u->marks->at, 0);
    assert_int_equal(u->pcm[0], 0);
    assert_int_equal(u->pcm[3999], 0);
    assert_true(largest_step(u) < 1200); /* the tone's own is 1003 */
    sentence_audio_cut(u, 0, 0);
    assert_int_equal(u->samples, 0);
    assert_int_equal(u->phone_count, 0);
    sentence_audio_free(u);
}

static void joints_are_tight(void **state) {
    (void)state;
    struct join_piece pieces[] = {{word(10000, 200, "a"), true, false},
                                  {word(16000, 300, "b"), true, true},
                                  {word(8000, 250, "c"), true, false}};
    struct sentence_audio *u = sentence_audio_join(pieces, 3, 10000);
    check_phones(u);
    assert_int_equal(u->word_count, 3);
    assert_int_equal(u->mark_count, 3);
    assert_int_equal(u->words[0].start, 2500);
    assert_in_range(u->words[1].start - u->words[0].end, 2 * 10 * JOIN_GAP_MS - 2, 2 * 10 * JOIN_GAP_MS + 2);
    assert_in_range(u->words[2].start - u->words[1].end, 10 * (JOIN_PAUSE_MS + JOIN_GAP_MS) - 2,
                    10 * (JOIN_PAUSE_MS + JOIN_GAP_MS) + 2);
    assert_int_equal(u->samples - u->words[2].end, 2500);
    for (size_t i = 0; i < 3; i++) {
        assert_in_range(u->marks[i].at, u->words[i].start - 1, u->words[i].start + 1);
        double from = u->words[i].start / 1e4, to = u->words[i].end / 1e4;
        assert_true(loudness(u, from + 0.01, to - 0.01) > 5000);
    }
    assert_true(loudness(u, u->words[1].end / 1e4 + 0.01, u->words[2].start / 1e4 - 0.01) < 20);
    sentence_audio_free(u);
}

/* Sounds and silences keep their length. */
static void what_is_no_speech_is_not_trimmed(void **state) {
    (void)state;
    struct sentence_audio *silence = mem_alloc(sizeof *silence);
    *silence = (struct sentence_audio){.sample_rate = 10000, .samples = 7000};
    silence->pcm = mem_alloc(7000 * sizeof *silence->pcm);
    silence->phones = mem_alloc(sizeof *silence->phones);
    silence->phones[silence->phone_count++] = (struct phone){.sampa = "_", .end = 7000};
    struct join_piece pieces[] = {{word(10000, 200, "a"), true, false},
                                  {silence, false, false},
                                  {word(10000, 200, "b"), true, false},
                                  {word(10000, 100, "c"), false, false}};
    struct sentence_audio *u = sentence_audio_join(pieces, 4, 10000);
    check_phones(u);
    assert_int_equal(u->words[1].start - u->words[0].end, 7000 + 2 * 10 * JOIN_GAP_MS);
    assert_int_equal(u->words[2].start - u->words[1].end, 2500 + 10 * JOIN_GAP_MS);
    assert_string_equal(u->lang, "b");
    sentence_audio_free(u);
}

static long faults(void) {
    struct rusage use;
    getrusage(RUSAGE_SELF, &use);
    return use.ru_minflt;
}

/* Long silence is neither written nor moved: two minutes of it with a word and a lead-in touch less than a
 * tenth of their memory. */
static void silence_costs_nothing(void **state) {
    (void)state;
    enum { SAMPLES = 120 * 22050, PAGES = SAMPLES * 2 / 4096 };
    struct sentence_audio *silence = mem_alloc(sizeof *silence);
    *silence = (struct sentence_audio){.sample_rate = 22050, .samples = SAMPLES};
    silence->phones = mem_alloc(sizeof *silence->phones);
    silence->phones[silence->phone_count++] = (struct phone){.sampa = "_", .end = SAMPLES};
    struct join_piece pieces[] = {{word(22050, 200, "a"), true, false}, {silence, false, false}};
    long before = faults();
    struct sentence_audio *u = sentence_audio_join(pieces, 2, 22050);
    uint32_t first = u->words->start, samples = u->samples;
    sentence_audio_lead_in(u, 700);
    long touched = faults() - before;
    assert_true(touched < PAGES / 2); /* includes the sanitizer's shadow memory, an eighth */
    assert_int_equal(u->words->start, first + 700);
    assert_int_equal(u->samples, samples + 700);
    check_phones(u);
    double from = u->words->start / 22050., to = u->words->end / 22050.;
    assert_true(loudness(u, from + 0.01, to - 0.01) > 5000);
    for (uint32_t i = u->words->end + 22050; i < u->samples; i++)
        assert_int_equal(u->pcm[i], 0);
    sentence_audio_free(u);
}

/* Without phones only true silence is trimmed; with phones a voice's echo is trimmed with the pause. */
static void where_sound_ends(void **state) {
    (void)state;
    uint32_t from, to;
    struct sentence_audio *u = word(10000, 200, "a");
    for (int i = 7500; i < 9000; i++)
        u->pcm[i] = 400;
    sentence_audio_bounds(u, &from, &to);
    assert_int_equal(from, 2500);
    assert_int_equal(to, 7500);
    u->phone_count = 0;
    sentence_audio_bounds(u, &from, &to);
    assert_int_equal(from, 2500);
    assert_int_equal(to, 9000);
    memset(u->pcm, 0, u->samples * sizeof *u->pcm);
    sentence_audio_bounds(u, &from, &to);
    assert_int_equal(from, to);
    sentence_audio_free(u);
}

static void nothing_at_all(void **state) {
    (void)state;
    struct sentence_audio *none = mem_alloc(sizeof *none);
    none->sample_rate = 16000;
    struct join_piece pieces[] = {{none, true, false}};
    struct sentence_audio *u = sentence_audio_join(pieces, 1, 22050);
    assert_int_equal(u->samples, 0);
    assert_int_equal(u->sample_rate, 22050);
    sentence_audio_free(u);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_rate),          cmocka_unit_test(cutting),
        cmocka_unit_test(joints_are_tight),      cmocka_unit_test(what_is_no_speech_is_not_trimmed),
        cmocka_unit_test(where_sound_ends),      cmocka_unit_test(nothing_at_all),
        cmocka_unit_test(silence_costs_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
