/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Styles of a score that reach a voice. */
#include "server/voice/voice_request.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct score_item *add(struct score *score, const char *text, struct score_style style) {
    size_t at = score->item_count ? score->items[score->item_count - 1].end : 0;
    struct score_item *item = score_add(score, SCORE_TEXT, at, at + strlen(text));
    item->text = text;
    item->verbatim = true;
    item->style = score_keep_style(score, &style);
    return item;
}

static const struct voice_prosody usual = {.own_rate = 170, .pitch = 1, .volume = 1};

static void styles_become_spans(void **state) {
    (void)state;
    struct score *score = score_new();
    struct score_style style = score_plain_style;
    struct voice_request request;
    add(score, "uno ", style);
    add(score, "due ", style);
    style.rate = 0.5;
    style.pitch = 1.2;
    style.volume = 0.5;
    add(score, "tre ", style);
    style.emotion = (struct score_emotion){"joy", 0.5};
    add(score, "quattro ", style);
    style.lang = "en";
    add(score, "five", style);
    score_end_sentence(score);
    struct voice_prosody prosody = usual;
    prosody.pitch = 2;
    prosody.volume = 3;
    voice_request_make(&request, score, 0, &prosody);
    assert_int_equal(request.span_count, 3);
    assert_string_equal(request.spans[0].text, "uno due ");
    assert_float_equal(request.spans[0].rate, 0, 1e-9);
    assert_string_equal(request.spans[1].text, "tre quattro "); /* the voice has no emotions */
    assert_float_equal(request.spans[1].rate, 85, 1e-9);
    assert_float_equal(request.spans[1].pitch, 2.4, 1e-9);
    assert_float_equal(request.spans[1].volume, 1.5, 1e-9);
    assert_null(request.spans[1].emotion);
    assert_string_equal(request.spans[2].lang, "en");
    voice_request_free(&request);
    prosody.plays = prosody.chosen = true;
    voice_request_make(&request, score, 0, &prosody);
    assert_int_equal(request.span_count, 4);
    assert_string_equal(request.spans[2].emotion, "joy");
    assert_float_equal(request.spans[2].intensity, 0.5, 1e-9);
    assert_null(request.spans[3].lang); /* the voice was chosen for the language */
    voice_request_free(&request);
    score_free(score);
}

static void a_part_of_a_sentence(void **state) {
    (void)state;
    struct score *score = score_new();
    struct voice_request request;
    size_t from, to;
    add(score, "uno ", score_plain_style);
    add(score, "due ", score_plain_style);
    score_add(score, SCORE_AUDIO, 8, 9)->text = "a.wav";
    add(score, "tre ", score_plain_style);
    score_end_sentence(score);
    score_add_cue(score, "affect", "joy", 0)->first = 0;
    voice_request_items(&request, score, 1, 3, &usual);
    assert_int_equal(request.cue_count, 0);
    assert_int_equal(request.span_count, 2); /* sounds are not part of the request, not even as a pause */
    assert_int_equal(request.from, 4);
    assert_int_equal(request.to, 13);
    assert_true(voice_request_locate(&request, 1, 0, 3, &from, &to));
    assert_int_equal(from, 9);
    assert_int_equal(to, 12);
    voice_request_free(&request);
    voice_request_cues(&request, score, 0);
    assert_int_equal(request.cue_count, 1);
    assert_int_equal(request.span_count, 0);
    voice_request_free(&request);
    score_free(score);
}

static void the_text_around(void **state) {
    (void)state;
    struct score *score = score_new();
    struct voice_request request;
    for (int i = 0; i < 200; i++) {
        char text[32];
        snprintf(text, sizeof text, "parola%03d ", i);
        add(score, "u", score_plain_style);
        add(score, "na ", score_plain_style);
        score_add(score, SCORE_MARK, 0, 0)->text = "m";
        add(score, score_strndup(score, text, sizeof text), score_plain_style);
        score_end_sentence(score);
    }
    voice_request_make(&request, score, 0, &usual);
    assert_null(request.before);
    voice_request_context(&request, score, 0, 0, 4);
    assert_null(request.before);
    assert_ptr_equal(strstr(request.after, "una parola001 "), request.after + strspn(request.after, " "));
    voice_request_free(&request);
    voice_request_make(&request, score, 100, &usual);
    voice_request_context(&request, score, 100, 400, 4);
    const struct faccia_sentence told = voice_request_sentence(&request, "x");
    assert_ptr_equal(told.before, request.before);
    assert_in_range(strlen(request.before), VOICE_CONTEXT_BYTES - 12, VOICE_CONTEXT_BYTES);
    assert_in_range(strlen(request.after), VOICE_CONTEXT_BYTES - 12, VOICE_CONTEXT_BYTES);
    assert_string_equal(request.before + strlen(request.before) - 14, "una parola099 ");
    assert_non_null(strstr(request.after, "una parola101 "));
    assert_null(strstr(request.after, "parola100"));
    voice_request_free(&request);
    voice_request_items(&request, score, 402, 2,
                        &usual); /* a part: the context includes the sentence before it */
    voice_request_context(&request, score, 100, 402, 2);
    assert_string_equal(request.before + strlen(request.before) - 4, "una ");
    voice_request_free(&request);
    voice_request_make(&request, score, 199, &usual);
    voice_request_context(&request, score, 199, 796, 4);
    assert_null(request.after);
    voice_request_free(&request);
    score_free(score);
}

/* Adds a comma after the last word if there is no full stop; offsets stay. */
static void a_sentence_that_goes_on(void **state) {
    (void)state;
    static const char *const cases[][2] = {{"uno ", "uno, "},  {"uno", "uno,"},       {"uno,", "uno,"},
                                           {"uno. ", "uno. "}, {"«già» ", "«già», "}, {"", ""},
                                           {"  ", "  "},       {"3 ", "3, "}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct score *score = score_new();
        struct voice_request request;
        size_t from, to;
        add(score, cases[i][0], score_plain_style);
        score_add(score, SCORE_MARK, 5, 5)->text = "m";
        score_end_sentence(score);
        voice_request_make(&request, score, 0, &usual);
        voice_request_continue(&request);
        assert_string_equal(*cases[i][1] ? request.spans[0].text : "", cases[i][1]);
        if (!strncmp(cases[i][1], "uno", 3)) {
            assert_true(voice_request_locate(&request, 0, 0, 3, &from, &to));
            assert_int_equal(to, 3);
        }
        voice_request_free(&request);
        score_free(score);
    }
    struct score *score = score_new();
    struct score_style style = score_plain_style;
    struct voice_request request;
    style.phonemes = "ˈuno";
    add(score, "uno", style);
    score_end_sentence(score);
    voice_request_make(&request, score, 0, &usual);
    voice_request_continue(&request);
    assert_string_equal(request.spans[0].text, "uno");
    voice_request_free(&request);
    score_free(score);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(styles_become_spans),
        cmocka_unit_test(a_part_of_a_sentence),
        cmocka_unit_test(the_text_around),
        cmocka_unit_test(a_sentence_that_goes_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
