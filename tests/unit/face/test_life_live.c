/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/life/life_live.h"
#include "server/face/track.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { FPS = 50, SECONDS_MOST = 40, PITCH = 48, YAW = 49, EYE_YAW = 23, EYE_PITCH = 25, BROW = 33, LID = 19 };

/* A voice with syllables of 0.2 s, 0.12 s of them pulses. */
struct voice {
    float samples[SECONDS_MOST * LIFE_LIVE_RATE];
    size_t count;
    double phase;
};

static void silence(struct voice *v, double seconds) {
    v->count += (size_t)(seconds * LIFE_LIVE_RATE);
}

static void syllables(struct voice *v, int count, double hz, double loud) {
    for (int i = 0; i < count * LIFE_LIVE_RATE / 5; i++) {
        double at = (double)(i % (LIFE_LIVE_RATE / 5)) / LIFE_LIVE_RATE;
        v->phase = fmod(v->phase + hz / LIFE_LIVE_RATE, 1);
        double open = at < 0.14 ? sin(M_PI * at / 0.14) : 0, tone = 0;
        for (int h = 1; h < 6; h++)
            tone += sin(2 * M_PI * h * v->phase) / h;
        v->samples[v->count++] = (float)(loud * (0.02 + open) * tone);
    }
}

static double seconds(const struct voice *v) {
    return (double)v->count / LIFE_LIVE_RATE;
}

struct shown {
    struct fap_frame frames[SECONDS_MOST * FPS];
    int count;
};

/* Displays the voice with a delay of 80 ms. */
static void show(const struct voice *v, struct shown *s, size_t piece) {
    struct life_live *l = life_live_new();
    size_t written = 0;
    s->count = 0;
    for (size_t step = 1; step * LIFE_LIVE_STEP <= v->count; step++) {
        while (written < v->count && written < step * LIFE_LIVE_STEP) {
            size_t size = piece < v->count - written ? piece : v->count - written;
            life_live_write(l, v->samples + written, size);
            written += size;
        }
        life_live_step(l);
        while (s->count / (double)FPS <= (double)step * LIFE_LIVE_STEP / LIFE_LIVE_RATE - 0.08) {
            struct fap_frame *frame = &s->frames[s->count];
            *frame = (struct fap_frame){0};
            memset(frame->mask, 0xff, sizeof frame->mask);
            life_live_add(l, s->count++ / (double)FPS, frame);
        }
    }
    life_live_free(l);
}

static int most(const struct shown *s, int fap, double from, double to) {
    int best = INT32_MIN;
    for (int k = (int)ceil(from * FPS); k < to * FPS && k < s->count; k++)
        best = s->frames[k].value[fap] > best ? s->frames[k].value[fap] : best;
    return best;
}

static bool looks(const struct shown *s, double t) {
    return fap_frame_has(&s->frames[(int)(t * FPS)], EYE_YAW);
}

static struct voice *voice_new(void **state) {
    struct voice *v = *state;
    memset(v, 0, sizeof *v);
    return v;
}

static struct shown a, b;

static void test_silence(void **state) {
    struct voice *v = voice_new(state);
    silence(v, 5);
    show(v, &a, 160);
    assert_int_equal(a.count, (int)((seconds(v) - 0.08) * FPS) + 1);
    for (int k = 0; k < a.count; k++) {
        assert_false(fap_frame_has(&a.frames[k], EYE_YAW));
        for (int n = 3; n <= FAP_COUNT; n++)
            assert_int_equal(a.frames[k].value[n], 0);
    }
}

/* A louder and higher syllable moves brows and head at about the time it is heard. */
static void test_stress(void **state) {
    struct voice *v = voice_new(state);
    silence(v, 0.5);
    syllables(v, 10, 120, 0.1);
    double at = seconds(v);
    syllables(v, 1, 150, 0.19);
    syllables(v, 6, 120, 0.1);
    show(v, &a, 160);
    assert_true(most(&a, BROW, 0, at) == 0 && most(&a, PITCH, 1.5, at) < 1745);
    assert_true(most(&a, BROW, at, at + 0.5) >= 45);
    assert_true(most(&a, PITCH, at, at + 0.5) > 1745);    /* a degree down */
    assert_true(most(&a, BROW, at + 0.9, at + 1.2) < 20); /* except for arousal */
}

/* The end of a phrase: a nod, and eyes on the listener, compensating the head. */
static void test_end(void **state) {
    struct voice *v = voice_new(state);
    bool blinked = false, aside = false;
    for (int phrase = 0; phrase < 6; phrase++) {
        silence(v, 1.5);
        double begin = seconds(v);
        syllables(v, 9, 120, 0.1);
        double end = seconds(v);
        silence(v, 1.4);
        show(v, &a, 160);
        assert_true(most(&a, PITCH, end, end + 0.7) > 1500);
        assert_true(looks(&a, end + 0.6));
        const struct fap_frame *f = &a.frames[(int)((end + 0.6) * FPS)];
        assert_int_equal(f->value[EYE_YAW], -f->value[YAW]);
        assert_int_equal(f->value[EYE_PITCH], -f->value[PITCH]);
        blinked |= most(&a, LID, end, end + 0.6) > 900;
        aside |=
            looks(&a, begin + 0.3) && abs(a.frames[(int)((begin + 0.3) * FPS)].value[EYE_YAW]) > 3 * 1745;
    }
    assert_true(blinked);
    assert_true(aside);
    silence(v, 3);
    show(v, &a, 160);
    assert_false(looks(&a, seconds(v) - 0.2)); /* the gaze is free again */
}

static void test_lively(void **state) {
    struct voice *v = voice_new(state);
    silence(v, 0.3);
    syllables(v, 40, 120, 0.05);
    double at = seconds(v);
    syllables(v, 10, 170, 0.2);
    show(v, &a, 160);
    int calm = 0, lively = 0; /* between prominent syllables */
    for (int k = (int)((at - 2) * FPS); k < at * FPS; k++)
        calm = a.frames[k].value[LID] < calm ? a.frames[k].value[LID] : calm;
    for (int k = (int)((at + 1) * FPS); k < a.count; k++)
        lively = a.frames[k].value[LID] < lively ? a.frames[k].value[LID] : lively;
    assert_true(lively < calm - 10);
}

/* Independent of later sound and of how it is split; never moves the mouth. */
static void test_causal(void **state) {
    struct voice *v = voice_new(state);
    silence(v, 0.4);
    syllables(v, 6, 120, 0.1);
    syllables(v, 2, 150, 0.2);
    silence(v, 0.6);
    double until = seconds(v) - 0.1;
    size_t count = v->count;
    syllables(v, 5, 180, 0.3);
    show(v, &a, 160);
    memset(v->samples + count, 0, (v->count - count) * sizeof *v->samples);
    show(v, &b, 77);
    for (int k = 0; k < until * FPS; k++) {
        assert_memory_equal(&a.frames[k], &b.frames[k], sizeof a.frames[k]);
        for (int n = 3; n <= 18; n++)
            assert_int_equal(a.frames[k].value[n], 0);
        for (int n = 51; n <= FAP_COUNT; n++)
            assert_int_equal(a.frames[k].value[n], 0);
    }
}

/* Noise, clipping and NaN: values stay within the FAPs' limits, and it terminates. */
static void test_anything(void **state) {
    struct voice *v = voice_new(state);
    unsigned long dice = 1;
    for (; v->count < 8 * LIFE_LIVE_RATE; v->count++) {
        dice = dice * 6364136223846793005u + 1442695040888963407u;
        double x = (double)(dice >> 40) / (1 << 23) - 1;
        v->samples[v->count] = (float)(v->count / LIFE_LIVE_RATE % 2 ? 3 * x : 1);
    }
    show(v, &a, 1000);
    for (int k = 0; k < a.count; k++)
        for (int n = 3; n <= FAP_COUNT; n++)
            assert_int_equal(a.frames[k].value[n], fap_clamp(n, a.frames[k].value[n]));
}

/* Scales with the strength of life; the mouth is always that of the frame. */
static void test_placed(void **state) {
    struct fap_frame heard = {0}, plain[2], moved;
    (void)state;
    memset(heard.mask, 0xff, sizeof heard.mask);
    heard.value[5] = -300;
    heard.value[BROW] = 80;
    heard.value[EYE_YAW] = heard.value[EYE_YAW + 1] = 9000;
    for (int i = 0; i < 2; i++) {
        const struct placement_options options = {.life = i, .seed = 5};
        struct face_placement *p = face_placement_new(NULL, NULL, &options);
        face_placement_sample(p, 7, &plain[i]);
        face_placement_sample_around(p, 7, &heard, &moved);
        assert_int_equal(moved.value[5], -300);
        assert_int_equal(moved.value[BROW], plain[i].value[BROW] + 80 * i);
        assert_int_equal(moved.value[EYE_YAW], i ? 9000 - moved.value[YAW] : plain[0].value[EYE_YAW]);
        face_placement_free(p);
    }
}

static int new_voice(void **state) {
    *state = calloc(1, sizeof(struct voice));
    return 0;
}

static int free_voice(void **state) {
    free(*state);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_silence), cmocka_unit_test(test_stress), cmocka_unit_test(test_end),
        cmocka_unit_test(test_lively),  cmocka_unit_test(test_causal), cmocka_unit_test(test_anything),
        cmocka_unit_test(test_placed),
    };
    return cmocka_run_group_tests(tests, new_voice, free_voice);
}
