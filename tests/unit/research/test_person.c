/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of curves with recordings, with exactly known results. */
#include "server/base/mem.h"
#include "server/research/measured_speech.h"
#include "server/research/person.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { FRAMES = 400 }; /* at 100 Hz: two whole periods of 2 s */

static double wave(void *ctx, double t) {
    (void)ctx;
    return sin(M_PI * t);
}

static double flat(void *ctx, double t) {
    (void)ctx;
    (void)t;
    return 3;
}

static void likeness_is_exact(void **state) {
    (void)state;
    double y[FRAMES], same[FRAMES], minus[FRAMES], quarter[FRAMES], still[FRAMES];
    for (int i = 0; i < FRAMES; i++) {
        y[i] = 7 + 2 * sin(2 * M_PI * i / 200);
        same[i] = 1 + sin(2 * M_PI * i / 200); /* half the amplitude, with an offset */
        minus[i] = -sin(2 * M_PI * i / 200);
        quarter[i] = 2 * cos(2 * M_PI * i / 200); /* orthogonal */
        still[i] = 5;
    }
    struct curve_match m = curve_match(y, same, FRAMES);
    assert_int_equal(m.count, FRAMES);
    assert_float_equal(m.correlation, 1, 1e-9);
    assert_float_equal(m.offset_rms, 1 / sqrt(2), 1e-9); /* of sin */
    assert_float_equal(m.affine_rms, 0, 1e-6);
    m = curve_match(y, minus, FRAMES);
    assert_float_equal(m.correlation, -1, 1e-9);
    assert_float_equal(m.offset_rms, 3 / sqrt(2), 1e-9);
    m = curve_match(y, quarter, FRAMES);
    assert_float_equal(m.correlation, 0, 1e-9);
    assert_float_equal(m.offset_rms, 2, 1e-9);
    assert_float_equal(m.affine_rms, sqrt(2), 1e-9);
    m = curve_match(y, still, FRAMES);
    assert_true(isnan(m.correlation));
    assert_float_equal(m.offset_rms, sqrt(2), 1e-9);
    assert_true(isnan(curve_match(y, y, 0).offset_rms));
}

static void shift_is_found(void **state) {
    (void)state;
    double times[FRAMES], y[FRAMES];
    for (int i = 0; i < FRAMES; i++) {
        times[i] = i / 100.0;
        y[i] = 4 * sin(M_PI * (times[i] - 0.035)); /* the person is 35 ms behind the prediction */
    }
    struct curve_match_shifted m = curve_match_shifted(times, y, FRAMES, wave, NULL, 0);
    assert_float_equal(m.shift, 0.035, 1e-9);
    assert_float_equal(m.best.correlation, 1, 1e-9);
    assert_float_equal(m.as_is.correlation, cos(M_PI * 0.035), 1e-9);
    assert_float_equal(m.best.offset_rms, 3 / sqrt(2), 1e-9);
    m = curve_match_shifted(times, y, FRAMES, wave, NULL, 0.035); /* already shifted */
    assert_float_equal(m.shift, 0, 1e-9);
    assert_float_equal(m.as_is.correlation, 1, 1e-9);
    for (int i = 0; i < FRAMES; i++) /* beyond the search range */
        y[i] = sin(M_PI * (times[i] + 0.2));
    assert_float_equal(curve_match_shifted(times, y, FRAMES, wave, NULL, 0).shift, -CURVE_SHIFT_MOST, 1e-9);
    m = curve_match_shifted(times, y, FRAMES, flat, NULL, 0);
    assert_true(m.shift == 0 && isnan(m.best.correlation));
}

/* "a.100 p.200": a person who says this, with a different height of the lower lip for each phone. */
static void say(struct measured_speech *person, const char *const *names, const double *lengths, size_t count,
                double lead) {
    double at = lead;
    struct error e;
    *person = (struct measured_speech){.repetitions = 1};
    struct recorded_phone silence = {"", 0, lead, 0};
    assert_int_equal(measured_speech_add(person, &silence, &e), 0);
    for (size_t i = 0; i < count; i++) {
        struct recorded_phone phone = {.start = at, .end = at + lengths[i]};
        snprintf(phone.ipa, sizeof phone.ipa, "%s", names[i]);
        assert_int_equal(measured_speech_add(person, &phone, &e), 0);
        at += lengths[i];
    }
    person->frame_count = (size_t)((at + lead) * 100) + 1;
    person->times = mem_alloc(person->frame_count * sizeof(double));
    person->curves[PARAM_LI] = mem_alloc(person->frame_count * sizeof(double));
    person->curves[PARAM_LS] = mem_alloc(person->frame_count * sizeof(double));
    for (size_t i = 0; i < person->frame_count; i++)
        person->times[i] = (double)i / 100;
}

static const char *const names[] = {"a", "p", "i", "s", "a"};
static const double lengths[] = {0.2, 0.1, 0.15, 0.15, 0.2}, slower[] = {0.4, 0.2, 0.3, 0.3, 0.4};

static void another_person_is_warped(void **state) {
    (void)state;
    struct measured_speech one, two;
    say(&one, names, lengths, 5, 0.2);
    say(&two, names, slower, 5, 0.5); /* half the speed, and later */
    for (size_t i = 0; i < two.frame_count; i++)
        two.curves[PARAM_LI][i] = 3 * two.times[i]; /* encodes the time */
    struct person_warp warp;
    person_warp_new(&warp, &one, &two);
    warp.measure = PARAM_LI;
    assert_int_equal(warp.matched, 5);
    assert_float_equal(person_warp_time(&warp, 0.2), 0.5, 1e-9);
    assert_float_equal(person_warp_time(&warp, 0.45), 1.0, 1e-9);
    assert_float_equal(person_warp_time(&warp, 1.0), 2.1, 1e-9);
    assert_float_equal(person_warp_time(&warp, 0.1), 0.4, 1e-9);   /* before: as time runs */
    assert_float_equal(person_warp_time(&warp, 1.05), 2.15, 1e-9); /* and behind */
    assert_float_equal(person_warp_at(&warp, 0.45), 3, 1e-9);
    /* the person's curve, warped in time, matches */
    for (size_t i = 0; i < one.frame_count; i++)
        one.curves[PARAM_LI][i] = 3 * person_warp_time(&warp, one.times[i]) + 8;
    struct curve_match_shifted m = person_match(&one, PARAM_LI, person_warp_at, &warp, 0);
    assert_float_equal(m.as_is.correlation, 1, 1e-9);
    assert_float_equal(m.as_is.offset_rms, 0, 1e-6);
    assert_int_equal(m.as_is.count, 81); /* 0.2 to 1.0 s: the pauses do not count */
    assert_true(m.shift == 0);
    person_warp_free(&warp);
    /* with a phone more and a phone less, common phones are matched */
    static const char *const others[] = {"a", "p", "u", "s", "t", "a"};
    static const double six[] = {0.2, 0.1, 0.15, 0.15, 0.1, 0.2};
    struct measured_speech three;
    say(&three, others, six, 6, 0.2);
    person_warp_new(&warp, &one, &three);
    assert_int_equal(warp.matched, 4);
    assert_float_equal(person_warp_time(&warp, 0.375), 0.575 - 0.2, 1e-9); /* in the middle of i, u */
    assert_float_equal(person_warp_time(&warp, 1.0), 1.1, 1e-9);
    person_warp_free(&warp);
    assert_false(person_has(&one, PARAM_AR));
    assert_true(person_has(&one, PERSON_APERTURE));
    measured_speech_free(&one);
    measured_speech_free(&two);
    measured_speech_free(&three);
}

/* A mouth at one height for each kind of phone, in mm. */
struct mouth {
    const struct phone_segments *g;
    double scale, offset;
    bool mixed; /* pronounces p like a */
};

static double mouth_at(void *ctx, int measure, double t) {
    const struct mouth *m = ctx;
    for (size_t i = 0; i < m->g->count; i++) {
        const struct phone_segment *item = &m->g->items[i];
        if (t < item->start || t >= item->end || !item->phone)
            continue;
        char letter = item->phone->ipa[0];
        double height = letter == 'a' || (m->mixed && letter == 'p') ? 10 : letter == 'p' ? 0 : 5;
        return m->offset + m->scale * height * (measure == PARAM_LI);
    }
    return m->offset;
}

static void people_teach_the_reader(void **state) {
    (void)state;
    struct error e = {0};
    struct speech_pack *pack = speech_pack_load(SOURCE_ROOT "/models/speech/it.json", &e);
    struct measured_speech one;
    struct phone_segments g;
    bool use[PERSON_MEASURES] = {[PARAM_LI] = true, [PARAM_LS] = true};
    say(&one, names, lengths, 5, 0.2);
    measured_speech_segments(pack, &one, NULL, NULL, &g);
    for (int mixed = 0; mixed < 2; mixed++) {
        struct mouth person = {&g, 1, 0, false}, engine = {&g, 0.5, 20, mixed};
        struct person_mouth learn = {pack, &g, mouth_at, &person}, read = {pack, &g, mouth_at, &engine};
        struct lip_reader reader = {0};
        person_reader_add(&reader, READER_LEARN, &learn, use);
        person_reader_add(&reader, READER_READ, &read, use);
        struct lip_reader_result result = reader_run(&reader);
        assert_int_equal(result.read, 5);
        if (mixed) /* distinct shapes, but not the person's */
            assert_true(result.right < 5);
        else /* size and position do not matter */
            assert_int_equal(result.right, 5);
        lip_reader_free(&reader);
    }
    phone_segments_free(&g);
    measured_speech_free(&one);
    speech_pack_free(pack);
}

static void arpabet(void **state) {
    (void)state;
    uint8_t stress;
    assert_string_equal(arpabet_ipa("AA1", &stress), "ɑː");
    assert_int_equal(stress, 2);
    assert_string_equal(arpabet_ipa("ah0", &stress), "ə");
    assert_string_equal(arpabet_ipa("AH2", &stress), "ʌ");
    assert_int_equal(stress, 1);
    assert_string_equal(arpabet_ipa("pcl", &stress), "p");
    assert_string_equal(arpabet_ipa("sp", &stress), "");
    assert_null(arpabet_ipa("ɑ", &stress));
    assert_null(arpabet_ipa("AA3", &stress));
    assert_null(arpabet_ipa("", &stress));
    assert_true(arpabet_is_telling("DH") && !arpabet_is_telling("b") && !arpabet_is_telling("sil"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(likeness_is_exact),
        cmocka_unit_test(shift_is_found),
        cmocka_unit_test(another_person_is_warped),
        cmocka_unit_test(people_teach_the_reader),
        cmocka_unit_test(arpabet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
