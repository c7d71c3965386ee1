/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of expressions on the voice. */
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static int load(void **state) {
    struct error e;
    *state = expressions_load(SOURCE_ROOT "/models/expressions.json", &e);
    return *state ? 0 : -1;
}

static int unload(void **state) {
    expressions_free(*state);
    return 0;
}

/* Four words, each an item, in one sentence. */
static struct score *four_words(void) {
    struct score *score = score_new();
    for (size_t i = 0; i < 4; i++)
        score_add(score, SCORE_TEXT, 5 * i, 5 * i + 4)->text = "word";
    score_end_sentence(score);
    return score;
}

static struct score_cue *add(struct score *score, const char *kind, const char *name, size_t first,
                             size_t last) {
    struct score_cue *cue = score_add_cue(score, kind, name, 5 * first);
    cue->first = first;
    cue->last = last;
    return cue;
}

static const struct voice_factors *factors(void *state, const char *kind, const char *name) {
    return &expressions_at(state, (size_t)expressions_find(state, kind, name))->voice;
}

static void assert_near(double a, double b) {
    assert_true(fabs(a - b) < 1e-9);
}

static void styles_what_is_under_a_cue(void **state) {
    struct score *score = four_words();
    const struct voice_factors *sad = factors(*state, "affect", "sadness");
    assert_true(sad->rate < 0.95 && sad->range < 0.9);
    add(score, "affect", "sad", 1, 3)->intensity = 0.5;
    expressions_direct(*state, score);
    assert_ptr_equal(score->items[0].style, &score_plain_style);
    assert_ptr_equal(score->items[3].style, &score_plain_style);
    for (int i = 1; i < 3; i++) {
        const struct score_style *style = score->items[i].style;
        assert_near(style->rate, 1 + (sad->rate - 1) / 2);
        assert_near(style->pitch, 1 + (sad->pitch - 1) / 2);
        assert_near(style->range, 1 + (sad->range - 1) / 2);
        assert_near(style->volume, 1 + (sad->volume - 1) / 2);
        assert_string_equal(style->emotion.name, "sadness"); /* by the affect's own name */
        assert_near(style->emotion.intensity, 0.5);
    }
    assert_int_equal(score->cue_count, 1);
    assert_int_equal(score->warning_count, 0);
    score_free(score);
}

static void multiplies_and_keeps_the_authors_own(void **state) {
    struct score *score = four_words();
    struct score_style slow = score_plain_style;
    slow.rate = 0.5;
    slow.emphasis = EMPHASIS_STRONG;
    score->items[1].style = score_keep_style(score, &slow);
    add(score, "affect", "anger", 0, 4);
    add(score, "affect", "joy", 1, 2);
    add(score, "pitch-accent", "hstar", 1, 2);
    expressions_direct(*state, score);
    const struct voice_factors *anger = factors(*state, "affect", "anger"),
                               *joy = factors(*state, "affect", "joy"),
                               *accent = factors(*state, "pitch-accent", "hstar");
    const struct score_style *style = score->items[1].style;
    assert_near(style->rate, 0.5 * anger->rate * joy->rate * accent->rate);
    assert_near(style->pitch, anger->pitch * joy->pitch * accent->pitch);
    assert_int_equal(style->emphasis, EMPHASIS_STRONG);
    assert_string_equal(style->emotion.name, "joy"); /* the innermost affect */
    assert_string_equal(score->items[2].style->emotion.name, "anger");
    score_free(score);
}

static void stays_a_voice(void **state) {
    struct score *score = four_words();
    for (int i = 0; i < 200; i++) {
        add(score, "affect", "anger", 0, 1);
        add(score, "affect", "sadness", 1, 2);
    }
    add(score, "affect", "joy", 2, 99)->intensity = NAN; /* beyond the end; NaN */
    expressions_direct(*state, score);
    for (size_t i = 0; i < 4; i++) {
        const struct score_style *style = score->items[i].style;
        assert_true(style->rate >= 0.5 && style->rate <= 2 && style->pitch >= 0.5 && style->pitch <= 2);
        assert_true(style->volume >= 0.3 && style->volume <= 2 && style->range >= 0.2 && style->range <= 3);
        assert_true(style->emotion.intensity >= 0 && style->emotion.intensity <= 1);
    }
    score_free(score);
}

static void removes_what_it_does_not_know(void **state) {
    struct score *score = four_words();
    add(score, "affect", "hunger", 2, 3);
    add(score, "affect", "joy", 0, 1);
    add(score, "weather", "rain", 0, 1);
    expressions_direct(*state, score);
    assert_int_equal(score->cue_count, 1);
    assert_string_equal(score->cues[0].name, "joy");
    assert_int_equal(score->warning_count, 2);
    assert_string_equal(error_name(score->warnings[0].code), "unknown-expression");
    assert_non_null(strstr(score->warnings[0].message, "hunger"));
    assert_int_equal(score->warnings[0].byte, 10);
    assert_ptr_equal(score->items[2].style, &score_plain_style);
    score_free(score);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(styles_what_is_under_a_cue),
        cmocka_unit_test(multiplies_and_keeps_the_authors_own),
        cmocka_unit_test(stays_a_voice),
        cmocka_unit_test(removes_what_it_does_not_know),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
