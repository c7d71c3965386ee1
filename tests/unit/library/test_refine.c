/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/align/refine.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Words of two phones: each kind of phone has features of its own, with some noise. */
enum { WORDS = 20, PHONES = 2 * WORDS, LENGTH = 12, KINDS = 5 };

static float noise(uint32_t *state) {
    *state = *state * 1664525 + 1013904223;
    return (float)(*state >> 8) / (1 << 24) - 0.5F;
}

static void fill(struct features *f, size_t from, size_t to, int kind, uint32_t *state) {
    for (size_t k = from; k < to; k++) {
        for (int c = 1; c < FEATURE_CEPSTRA; c++)
            f->frames[k][c] = kind < 0 ? 0 : sinf((float)(c * (kind + 1))) + 0.6F * noise(state);
        f->frames[k][0] = kind < 0 ? 0 : 0.8F;
        f->silent[k] = kind < 0;
    }
}

static void open_features(struct features *f, size_t count) {
    f->count = count;
    f->frames = mem_alloc(count * sizeof *f->frames);
    f->silent = mem_alloc(count * sizeof *f->silent);
}

struct scene {
    struct features recording, reference;
    struct refine_phone phones[PHONES];
    double begins[PHONES];
};

/* The recording pauses for `pause` frames before each fifth word, and its sounds last 8 to 16 frames. */
static void open_scene(struct scene *s, size_t pause, int kinds) {
    uint32_t state = 1;
    size_t at = 40;
    open_features(&s->recording, 80 + PHONES * 16 + WORDS / 5 * pause);
    open_features(&s->reference, PHONES * LENGTH);
    fill(&s->recording, 0, s->recording.count, -1, &state);
    for (size_t i = 0; i < PHONES; i++) {
        int kind = (int)(i * i / 2 + i) % kinds;
        size_t length = LENGTH - 4 + i % 9;
        at += i && i % 10 == 0 ? pause : 0;
        fill(&s->reference, i * LENGTH, (i + 1) * LENGTH, kind, &state);
        fill(&s->recording, at, at + length, kind, &state);
        s->begins[i] = (double)at;
        s->phones[i] = (struct refine_phone){
            .word = i % 2 == 0, .from = i * LENGTH, .to = (i + 1) * LENGTH, .start = at, .end = at + length};
        snprintf(s->phones[i].ipa, sizeof s->phones[i].ipa, "%c", "aeopt"[kind]);
        at += length;
    }
}

static void close_scene(struct scene *s) {
    features_free(&s->recording);
    features_free(&s->reference);
}

/* Moves what the warp has found by up to 30 frames. */
static void disturb(struct scene *s) {
    for (size_t i = 0; i < PHONES; i++) {
        int by = (int)(20 * sin((double)i / 4)) + (i > 30 ? 10 : 0);
        s->phones[i].start = (size_t)((int)s->phones[i].start + by);
        s->phones[i].end = (size_t)((int)s->phones[i].end + by);
        if (i && s->phones[i].start < s->phones[i - 1].end)
            s->phones[i].start = s->phones[i - 1].end;
        if (s->phones[i].end < s->phones[i].start)
            s->phones[i].end = s->phones[i].start;
    }
}

static void finds_displaced_phones_and_pauses(void **state) {
    (void)state;
    for (size_t pause = 0; pause <= 60; pause += 30) {
        struct scene *s = mem_alloc(sizeof *s);
        struct refine_model *model = refine_model_new();
        size_t right = 0;
        open_scene(s, pause, KINDS);
        disturb(s);
        assert_true(refine(model, &s->recording, &s->reference, NULL, s->phones, PHONES, NULL));
        for (size_t i = 0; i < PHONES; i++) {
            right += fabs(s->phones[i].begins - s->begins[i]) <= 2;
            assert_true(s->phones[i].ends >= s->phones[i].begins);
            assert_true(!i || s->phones[i].begins >= s->phones[i - 1].ends);
            assert_true(s->phones[i].sure >= 0 && s->phones[i].sure <= 1);
        }
        assert_in_range(right, PHONES * 9 / 10, PHONES);
        refine_model_free(model);
        close_scene(s);
        free(s);
    }
}

static void doubts_sounds_that_are_all_alike(void **state) {
    (void)state;
    double sure[2] = {0};
    for (int alike = 0; alike < 2; alike++) {
        struct scene *s = mem_alloc(sizeof *s);
        struct refine_model *model = refine_model_new();
        open_scene(s, 0, alike ? 1 : KINDS);
        assert_true(refine(model, &s->recording, &s->reference, NULL, s->phones, PHONES, NULL));
        for (size_t i = 0; i < PHONES; i++)
            sure[alike] += (double)s->phones[i].sure / PHONES;
        refine_model_free(model);
        close_scene(s);
        free(s);
    }
    assert_true(sure[0] > 0.95);
    assert_true(sure[1] < sure[0] - 0.05);
}

static void leaves_impossible_and_stopped_work(void **state) {
    (void)state;
    struct scene *s = mem_alloc(sizeof *s);
    struct refine_model *model = refine_model_new();
    atomic_bool stop = true;
    open_scene(s, 0, KINDS);
    assert_false(refine(model, &s->recording, &s->reference, NULL, s->phones, 0, NULL));
    assert_false(refine(model, &s->recording, &s->reference, NULL, s->phones, PHONES, &stop));
    for (size_t i = 0; i < PHONES; i++) /* all at the recording's end, where there is no room for them */
        s->phones[i].start = s->phones[i].end = s->recording.count + 10;
    s->recording.count = PHONES / 2;
    assert_false(refine(model, &s->recording, &s->reference, NULL, s->phones, PHONES, NULL));
    refine_model_free(model);
    close_scene(s);
    free(s);
}

static void knows_the_classes_of_phones(void **state) {
    (void)state;
    static const struct {
        const char *ipa;
        int classes[SOUND_CLASS_PARTS];
    } cases[] = {
        {"p", {LIP_CLOSED, LIP_CLOSED, LIP_CLOSED}},
        {"t͡ʃ", {LIP_ROUNDED, LIP_ROUNDED, LIP_ROUNDED}},
        {"aɪ", {LIP_OPEN, LIP_OPEN, LIP_CLOSE}},
        {"uː", {LIP_CLOSE_ROUND, LIP_CLOSE_ROUND, LIP_CLOSE_ROUND}},
        {"ʘ", {-1, -1, -1}},
        {"", {-1, -1, -1}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int found[SOUND_CLASS_PARTS];
        sound_classes_of(cases[i].ipa, found);
        assert_memory_equal(found, cases[i].classes, sizeof found);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_displaced_phones_and_pauses),
        cmocka_unit_test(doubts_sounds_that_are_all_alike),
        cmocka_unit_test(leaves_impossible_and_stopped_work),
        cmocka_unit_test(knows_the_classes_of_phones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
