/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures of faces with known values. */
#include "server/base/mem.h"
#include "server/face/engines/contact.h"
#include "server/face/track.h"
#include "server/research/eval.h"
#include "server/research/plot.h"
#include "tests/unit/pack_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RATE = 1000 };

enum {
    LIPS_SEEN,
    LIPS_HELD,
    TEETH_SEEN,
    TEETH_HELD,
    OPENING,
    OPENING_ERROR,
    ROUNDING,
    PROTRUSION,
    ANTICIPATION,
    SPEED,
    JERK,
    OVERLAP,
    READER,
    USUAL
};

static int load(void **state) {
    return pack_load(state, "it");
}

/* A face given by functions of time, mm of the modelled speaker. */
struct puppet {
    const struct speech_pack *pack;
    double (*gap)(double t);
    double narrowing, protrusion, lower; /* lower: mm by which the lower lip is raised at constant gap */
    double overlap;                      /* mm of the left side */
};

static void pose(void *self, double t, struct fap_frame *frame) {
    const struct puppet *p = self;
    double mns = 1024 / p->pack->fapu.mns, mw = 1024 / p->pack->fapu.mw, lower = p->lower * mns;
    *frame = (struct fap_frame){0};
    fap_frame_set(frame, 5, (int32_t)lround(lower));
    fap_frame_set(frame, 4, (int32_t)lround(-p->gap(t) * mns) - frame->value[5]);
    fap_frame_set(frame, 6, (int32_t)lround(-p->narrowing / 2 * mw));
    fap_frame_set(frame, 7, (int32_t)lround(-p->narrowing / 2 * mw));
    fap_frame_set(frame, 16, (int32_t)lround(p->protrusion * mns));
    fap_frame_set(frame, 17, (int32_t)lround(p->protrusion * mns));
    fap_frame_set(frame, 8, (int32_t)lround(p->overlap * mns));
}

/* Phones as "p.080 a.120 _.300": name and duration in ms. Every run of phones between pauses is a word "w".
 */
static struct sentence_audio *utter(const char *text) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    char *copy = mem_strdup(text), *save;
    bool in_word = false;
    u->sample_rate = RATE;
    for (char *item = strtok_r(copy, " ", &save); item; item = strtok_r(NULL, " ", &save)) {
        u->phones = mem_resize(u->phones, (u->phone_count + 1) * sizeof *u->phones);
        u->words = mem_resize(u->words, (u->word_count + 1) * sizeof *u->words);
        struct phone *p = &u->phones[u->phone_count++];
        char *dot = strchr(item, '.');
        *p = (struct phone){.start = u->samples};
        *dot = '\0';
        if (strcmp(item, "_") != 0)
            snprintf(p->ipa, sizeof p->ipa, "%s", item);
        u->samples += (uint32_t)atoi(dot + 1);
        p->end = u->samples;
        if (p->ipa[0] && !in_word)
            u->words[u->word_count++] = (struct word){.start = p->start, .end = p->end, .to = 1};
        in_word = p->ipa[0] != '\0';
        if (in_word)
            u->words[u->word_count - 1].end = p->end;
    }
    free(copy);
    return u;
}

static void done(struct sentence_audio *u) {
    free(u->phones);
    free(u->words);
    free(u);
}

static void measure(const char *text, const struct puppet *puppet, double fps, double values[EVAL_MEASURES]) {
    struct sentence_audio *u = utter(text);
    struct eval e = {0};
    struct eval_input in = {puppet->pack, u, "w", {pose, (void *)puppet}, fps, 0};
    eval_add(&e, &in);
    eval_values(&e, values);
    eval_free(&e);
    done(u);
}

static double shut(double t) {
    (void)t;
    return 0;
}

static double open_5(double t) {
    (void)t;
    return 5;
}

/* Gap that closes from 0.5 to 0.58 s. */
static double blink(double t) {
    return t >= 0.5 && t <= 0.58 ? -0.1 : 5;
}

static void closures(void **state) {
    struct puppet p = {.pack = *state, .gap = shut};
    double v[EVAL_MEASURES];
    /* /m/ sounds from 500 to 600 ms; its middle third is 533 to 567 */
    const char *text = "_.400 a.100 m.100 a.100 _.100";
    measure(text, &p, 25, v);
    assert_true(v[LIPS_SEEN] == 1 && v[LIPS_HELD] == 1);
    assert_true(isnan(v[TEETH_SEEN]) && isnan(v[TEETH_HELD]));
    p.gap = open_5;
    measure(text, &p, 25, v);
    assert_true(v[LIPS_SEEN] == 0 && v[LIPS_HELD] == 0);
    p.gap = blink; /* visible at 0.52 and 0.56, and held */
    measure(text, &p, 25, v);
    assert_true(v[LIPS_SEEN] == 1 && v[LIPS_HELD] == 1);
    measure("_.400 a.130 m.080 a.100 _.100", &p, 25, v); /* opens before its middle third, 557 to 583, ends */
    assert_true(v[LIPS_SEEN] == 1 && v[LIPS_HELD] == 0);
    measure("_.400 a.060 m.060 a.100 _.100", &p, 25, v); /* closes too late, except for the frame at 0.52 */
    assert_true(v[LIPS_SEEN] == 0 && v[LIPS_HELD] == 0);
    measure("_.400 a.100 m.080 a.100 b.100 a.100 _.100", &p, 25, v);
    assert_true(v[LIPS_SEEN] == 0.5 && v[LIPS_HELD] == 0.5);
    measure("_.400 a.110 m.060 a.100 _.100", &p, 1, v); /* the frame of 0 s is still displayed */
    assert_true(v[LIPS_SEEN] == 0 && v[LIPS_HELD] == 1);
}

static void teeth(void **state) {
    const char *text = "_.400 a.100 f.100 a.100 _.100";
    double v[EVAL_MEASURES];
    /* the rule of /f/: at most 1.5 mm below rest, at least 1.6 mm back */
    struct puppet p = {.pack = *state, .gap = open_5, .lower = -1.5, .protrusion = -1.6};
    measure(text, &p, 25, v);
    assert_true(v[TEETH_SEEN] == 1 && v[TEETH_HELD] == 1 && isnan(v[LIPS_SEEN]));
    p.lower = -1.6;
    measure(text, &p, 25, v);
    assert_true(v[TEETH_SEEN] == 0 && v[TEETH_HELD] == 0);
    p.lower = 0;
    p.protrusion = -1.5;
    measure(text, &p, 25, v);
    assert_true(v[TEETH_SEEN] == 0);
}

static void vowels(void **state) {
    double v[EVAL_MEASURES];
    struct puppet p = {.pack = *state, .gap = open_5};
    /* before a pause an unstressed /a/ opens by 4.83 + 2.4 mm; without any stress told, half-way to stressed
     */
    const struct speech_phone *a = speech_pack_phone(*state, "a", 1), *u = speech_pack_phone(*state, "u", 1);
    assert_float_equal(a->plain[PARAM_LI].T + a->plain[PARAM_LS].T, 4.83 + 2.4, 1e-9);
    double target =
        (a->plain[PARAM_LI].T + a->stressed[PARAM_LI].T + a->plain[PARAM_LS].T + a->stressed[PARAM_LS].T) / 2;
    measure("_.100 a.200 _.100", &p, 25, v);
    assert_float_equal(v[OPENING], 5 / target, 0.005);
    assert_float_equal(v[OPENING_ERROR], fabs(5 - target), 0.02);
    assert_true(isnan(v[ROUNDING]) && isnan(v[ANTICIPATION]));
    double narrow = -(u->plain[PARAM_AR].T + u->stressed[PARAM_AR].T) / 2;
    double push =
        (u->plain[PARAM_PI].T + u->stressed[PARAM_PI].T + u->plain[PARAM_PS].T + u->stressed[PARAM_PS].T) / 4;
    p.narrowing = narrow / 2;
    p.protrusion = push;
    measure("_.100 k.100 u.200 _.100", &p, 25, v);
    assert_float_equal(v[ROUNDING], 0.5, 0.01);
    assert_float_equal(v[ANTICIPATION], 0.5, 0.01);
    assert_float_equal(v[PROTRUSION], 1, 0.02);
}

static double ramp(double t) {
    return 50 * t;
}

static double cube(double t) {
    return 100 * t * t * t;
}

static void motion(void **state) {
    double v[EVAL_MEASURES];
    struct puppet p = {.pack = *state, .gap = ramp};
    measure("_.100 a.200", &p, 25, v);
    assert_float_equal(v[SPEED], 50, 1.1); /* two roundings of 0.02 mm in 0.04 s */
    p.gap = cube;
    measure("_.100 a.900", &p, 10, v);
    assert_float_equal(v[JERK], 600, 4 * 0.021 * 1000);
    assert_true(v[OVERLAP] == 0);
    p.overlap = 0.3;
    measure("_.100 a.200", &p, 25, v);
    assert_true(v[OVERLAP] == 0);
    p.overlap = 0.8;
    measure("_.100 a.200", &p, 25, v);
    assert_float_equal(v[OVERLAP], 0.5, 0.035);
}

static void reader(void **state) {
    (void)state;
    static const char classes[3];
    struct lip_reader r = {0};
    assert_int_equal(reader_run(&r).read, 0);
    for (int i = 0; i < 60; i++) {
        struct lip_reader_sample s = {.class = &classes[i % 3]};
        s.features[7] = (float)(1000 * (i % 3)); /* distinguishes the classes, */
        s.features[8] = (float)(i * 7 % 10);     /* unlike this one */
        lip_reader_add(&r, i < 30 ? READER_LEARN : READER_READ, &s);
    }
    struct lip_reader_sample stranger = {.class = &r};
    lip_reader_add(&r, READER_READ, &stranger); /* of an unknown class */
    struct lip_reader_result result = reader_run(&r);
    assert_int_equal(result.read, 31);
    assert_int_equal(result.right, 30);
    assert_int_equal(result.usual, 10);
    lip_reader_free(&r);
}

static void lip_reader_scales(void **state) {
    (void)state;
    /* without scaling, the large feature would hide the small one that distinguishes the classes */
    static const char classes[2];
    struct lip_reader r = {0};
    for (int i = 0; i < 80; i++) {
        struct lip_reader_sample s = {.class = &classes[i % 2]};
        s.features[0] = (float)(i % 2);
        s.features[1] = (float)(1000 * sin(i));
        lip_reader_add(&r, i < 40 ? READER_LEARN : READER_READ, &s);
    }
    assert_int_equal(reader_run(&r).right, 40);
    lip_reader_free(&r);
}

static void halves(void **state) {
    (void)state;
    int count[READER_HALVES] = {0};
    char word[16];
    for (int i = 0; i < 1000; i++)
        count[lip_reader_half(word, (size_t)snprintf(word, sizeof word, "w%d", i))]++;
    assert_in_range(count[0], 400, 600);
    assert_int_equal(lip_reader_half("Mamma", 5), lip_reader_half("mamma", 5));
}

static void sample(void *track, double t, struct fap_frame *frame) {
    face_track_sample(track, t, frame);
}

static void default_engine(void **state) {
    struct sentence_audio *u =
        utter("_.100 p.030 a.050 p.020 a.040 f.025 a.050 m.020 o.060 v.030 u.050 b.040 o.060 _.200");
    struct face_options options = {.still = true};
    struct face_track *track = face_track_new(*state, u, &options, NULL, NULL);
    struct eval_input in = {*state, u, "w", {sample, track}, 25, 0.013};
    struct eval e = {0};
    double v[EVAL_MEASURES];
    eval_add(&e, &in);
    assert_int_equal(e.lips.count, 4);
    assert_int_equal(e.teeth.count, 2);
    eval_values(&e, v);
    assert_true(v[LIPS_SEEN] == 1 && v[LIPS_HELD] == 1 && v[TEETH_SEEN] == 1 && v[TEETH_HELD] == 1);
    assert_true(v[OVERLAP] == 0);
    eval_free(&e);
    face_track_free(track);
    done(u);
}

static void picture(void **state) {
    struct sentence_audio *u = utter("_.100 p.080 a.150 p.080 a.140 _.300");
    struct puppet p = {.pack = *state, .gap = open_5};
    struct eval_input in = {*state, u, "w", {pose, &p}, 25, 0};
    struct stretch_choice choice = {0};
    struct stretch stretch = {0};
    assert_true(stretch_choose(&choice, *state, u, 0));
    assert_int_equal(choice.contacts, 2);
    assert_false(stretch_choose(&choice, *state, u, 1));
    stretch_take(&stretch, &choice, &in, 0);
    assert_float_equal(stretch.seconds, 0.65, 1e-6);
    assert_float_equal(stretch.gaps[0][250], 5, 0.02);
    assert_int_equal(stretch.span_count, 2);
    const char *const engines[] = {"a<b"};
    double rates[] = {100}, values[1][EVAL_MEASURES];
    for (int i = 0; i < EVAL_MEASURES; i++)
        values[0][i] = i % 2 ? NAN : 0.5;
    struct plot plot = {"A & B",  engines, 1, rates, 1, (const double(*)[EVAL_MEASURES])values,
                        &stretch, NULL};
    struct buf out = {0};
    plot_draw(&plot, &out);
    buf_add(&out, "", 1);
    assert_non_null(strstr((char *)out.data, "A &amp; B"));
    assert_non_null(strstr((char *)out.data, "a&lt;b"));
    assert_null(strstr((char *)out.data, "nan"));
    buf_free(&out);
    stretch_free(&stretch);
    done(u);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(closures, load, pack_unload),
        cmocka_unit_test_setup_teardown(teeth, load, pack_unload),
        cmocka_unit_test_setup_teardown(vowels, load, pack_unload),
        cmocka_unit_test_setup_teardown(motion, load, pack_unload),
        cmocka_unit_test(reader),
        cmocka_unit_test(lip_reader_scales),
        cmocka_unit_test(halves),
        cmocka_unit_test_setup_teardown(default_engine, load, pack_unload),
        cmocka_unit_test_setup_teardown(picture, load, pack_unload),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
