/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/assembly.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RATE = 16000 };

/* A sentence of a voice: its score, request and audio. */
struct media_segment {
    struct score *score;
    struct voice_request request;
    struct assembly *assembly;
    struct sentence_audio *u;
};

static void add_text(struct score *score, size_t start, const char *text, bool verbatim,
                     const struct score_style *style) {
    struct score_item *item = score_add(score, SCORE_TEXT, start, start + strlen(text));
    item->text = score_strndup(score, text, strlen(text));
    item->verbatim = verbatim;
    if (style)
        item->style = style;
}

static void request(struct media_segment *s) {
    score_end_sentence(s->score);
    voice_request_make(&s->request, s->score, 0,
                       &(struct voice_prosody){.own_rate = 100, .pitch = 1, .volume = 1});
    s->assembly = assembly_new(&s->request);
}

static void begin(struct media_segment *s, const char *text) {
    *s = (struct media_segment){.score = score_new()};
    add_text(s->score, 0, text, true, NULL);
    request(s);
}

static void end(struct media_segment *s) {
    sentence_audio_free(s->u);
    assembly_free(s->assembly);
    voice_request_free(&s->request);
    score_free(s->score);
}

static int audio(struct media_segment *s, size_t samples, uint32_t rate, struct error *e) {
    struct buf b = {0};
    wire_put_u32(&b, rate);
    memset(buf_reserve(&b, samples * 2), 0, samples * 2);
    b.size += samples * 2;
    const struct wire_frame frame = {.data = b.data, .size = b.size};
    int result = assembly_audio(s->assembly, &frame, e);
    buf_free(&b);
    return result;
}

static int event(struct media_segment *s, const struct wire_event *event, struct error *e) {
    struct buf b = {0};
    wire_put_event(&b, event);
    const struct wire_frame frame = {.data = b.data, .size = b.size};
    int result = assembly_events(s->assembly, &frame, e);
    buf_free(&b);
    return result;
}

static void phone(struct media_segment *s, const char *ipa, uint64_t start, uint64_t end_) {
    struct error e;
    assert_int_equal(
        event(s, &(struct wire_event){.kind = WIRE_PHONE, .phone = {ipa, "x", start, end_, 0}}, &e), 0);
}

static void word(struct media_segment *s, uint32_t span, size_t offset, size_t bytes, uint64_t start) {
    struct error e;
    assert_int_equal(
        event(s, &(struct wire_event){.kind = WIRE_WORD, .word = {span, offset, bytes, start, 0}}, &e), 0);
}

static void mark(struct media_segment *s, const char *name, uint64_t at) {
    struct error e;
    assert_int_equal(event(s, &(struct wire_event){.kind = WIRE_MARK, .text = name, .at = at}, &e), 0);
}

static void finish(struct media_segment *s) {
    s->u = assembly_finish(s->assembly, "it", RATE, NULL);
    uint32_t at = 0;
    for (size_t i = 0; i < s->u->phone_count; i++) {
        assert_int_equal(s->u->phones[i].start, at);
        assert_true(s->u->phones[i].end >= at);
        at = s->u->phones[i].end;
    }
    assert_int_equal(at, s->u->samples);
}

static void check_phone(const struct media_segment *s, size_t i, const char *ipa, uint32_t start,
                        uint32_t end_) {
    assert_true(i < s->u->phone_count);
    assert_string_equal(s->u->phones[i].ipa, ipa);
    assert_int_equal(s->u->phones[i].start, start);
    assert_int_equal(s->u->phones[i].end, end_);
}

static void check_word(const struct media_segment *s, size_t i, uint32_t start, uint32_t end_, size_t from,
                       size_t to) {
    assert_true(i < s->u->word_count);
    assert_int_equal(s->u->words[i].start, start);
    assert_int_equal(s->u->words[i].end, end_);
    assert_int_equal(s->u->words[i].from, from);
    assert_int_equal(s->u->words[i].to, to);
}

static void fills_gaps_with_pauses(void **state) {
    (void)state;
    struct media_segment s;
    struct error e;
    begin(&s, "pa");
    assert_int_equal(audio(&s, 1000, RATE, &e), 0);
    phone(&s, "p", 100, 200);
    phone(&s, "", 200, 250);
    phone(&s, "a", 300, 400);
    phone(&s, "", 400, 400);
    word(&s, 0, 0, 2, 100);
    finish(&s);
    assert_int_equal(s.u->phone_count, 5);
    check_phone(&s, 0, "", 0, 100);
    check_phone(&s, 1, "p", 100, 200);
    check_phone(&s, 2, "", 200, 300);
    check_phone(&s, 3, "a", 300, 400);
    check_phone(&s, 4, "", 400, 1000);
    assert_string_equal(s.u->phones[2].sampa, "_");
    assert_string_equal(s.u->phones[0].sampa, "_");
    check_word(&s, 0, 100, 400, 0, 2); /* without the pause after it */
    assert_int_equal(s.u->warning_count, 0);
    end(&s);
}

static void mends_times_with_a_warning(void **state) {
    (void)state;
    struct media_segment s;
    struct error e;
    begin(&s, "uno due");
    assert_int_equal(audio(&s, 1000, RATE, &e), 0);
    phone(&s, "a", 0, 500);
    phone(&s, "b", 400, 600);
    phone(&s, "d", 300, 200);
    phone(&s, "e", 900, UINT64_MAX);
    word(&s, 0, 0, 3, 500);
    word(&s, 0, 4, 3, 2);
    finish(&s);
    check_phone(&s, 0, "a", 0, 400);
    check_phone(&s, 1, "b", 400, 400); /* d claims to begin before it, so it ends at its own start */
    check_phone(&s, 2, "d", 400, 400);
    check_phone(&s, 3, "", 400, 900);
    check_phone(&s, 4, "e", 900, 1000);
    check_word(&s, 0, 500, 500, 0, 3);
    check_word(&s, 1, 500, 1000, 4, 7);
    assert_true(s.u->warning_count >= 3);
    end(&s);
}

static void nothing_said_is_one_pause(void **state) {
    (void)state;
    struct media_segment s;
    struct error e;
    begin(&s, "mm");
    assert_int_equal(audio(&s, 10, RATE, &e), 0);
    finish(&s);
    assert_int_equal(s.u->phone_count, 1);
    check_phone(&s, 0, "", 0, 10);
    end(&s);
    begin(&s, "...");
    finish(&s);
    assert_int_equal(s.u->samples, 0);
    assert_int_equal(s.u->sample_rate, RATE);
    assert_int_equal(s.u->phone_count, 0);
    end(&s);
}

static void refuses_broken_audio(void **state) {
    (void)state;
    struct media_segment s;
    struct error e;
    begin(&s, "a");
    assert_int_equal(audio(&s, 10, 4000, &e), -1);
    assert_string_equal(error_name(e.code), "voice-failed");
    assert_int_equal(audio(&s, 10, UINT32_MAX, &e), -1);
    assert_int_equal(audio(&s, 10, RATE, &e), 0);
    assert_int_equal(audio(&s, 10, RATE * 2, &e), -1);
    const struct wire_frame odd = {.data = (const uint8_t *)"\x80\x3e\0\0x", .size = 5},
                            none = {.data = NULL};
    assert_int_equal(assembly_audio(s.assembly, &odd, &e), -1);
    assert_int_equal(assembly_audio(s.assembly, &none, &e), -1);
    int result = 0;
    for (int seconds = 0; seconds < ASSEMBLY_SECONDS + 1 && !result; seconds++)
        result = audio(&s, RATE, RATE, &e);
    assert_int_equal(result, -1);
    end(&s);
}

static void refuses_too_many_events(void **state) {
    (void)state;
    struct media_segment s;
    struct error e;
    int count = 0;
    begin(&s, "a");
    while (event(&s, &(struct wire_event){.kind = WIRE_WARNING, .text = "w"}, &e) == 0)
        count++;
    assert_int_equal(count, ASSEMBLY_EVENTS + ASSEMBLY_EVENTS_PER_BYTE);
    assert_string_equal(error_name(e.code), "voice-failed");
    finish(&s);
    assert_int_equal(s.u->warning_count, 1); /* the same warning only once */
    end(&s);
}

static void cuts_names_between_characters(void **state) {
    (void)state;
    struct media_segment s;
    struct error e;
    begin(&s, "a");
    assert_int_equal(audio(&s, 10, RATE, &e), 0);
    phone(&s, "ɑɑɑɑɑɑɑɑ", 0, 5);
    phone(&s, "b\xFFzz", 5, 10);
    finish(&s);
    check_phone(&s, 0, "ɑɑɑɑɑɑɑ", 0, 5);
    check_phone(&s, 1, "b", 5, 10);
    assert_int_equal(s.u->warning_count, 2);
    end(&s);
}

/* A voice that reports only the starts of words: each lasts until the next. */
static void keeps_words_without_phones(void **state) {
    (void)state;
    struct media_segment s;
    struct error e;
    begin(&s, "uno due");
    assert_int_equal(audio(&s, 1000, RATE, &e), 0);
    word(&s, 0, 0, 3, 100);
    word(&s, 0, 4, 3, 600);
    finish(&s);
    check_word(&s, 0, 100, 600, 0, 3);
    check_word(&s, 1, 600, 1000, 4, 7);
    assert_string_equal(s.u->words[1].text, "due");
    end(&s);
}

/* "<b>L</b>'<b>amica</b> 12 €": items of one style joined, one replaced, one in another style. */
static void maps_words_to_the_input(void **state) {
    (void)state;
    const struct score_style loud = {.rate = 2, .pitch = 1, .range = 1, .volume = 1};
    struct media_segment s = {.score = score_new()};
    struct error e;
    add_text(s.score, 3, "L'", true, NULL);
    add_text(s.score, 12, "amìca ", true, NULL);
    add_text(s.score, 20, "dodici", false, NULL); /* input bytes 20..26 */
    add_text(s.score, 30, "euro", true, &loud);
    request(&s);
    assert_int_equal(s.request.span_count, 2);
    assert_string_equal(s.request.spans[0].text, "L'amìca dodici");
    assert_float_equal(s.request.spans[0].rate, 0, 0);
    assert_float_equal(s.request.spans[1].rate, 200, 0); /* twice the voice's own */
    assert_int_equal(audio(&s, 1000, RATE, &e), 0);
    phone(&s, "a", 0, 1000);
    word(&s, 0, 0, 8, 0);    /* L'amìca */
    word(&s, 0, 9, 2, 200);  /* do-: inside the replaced text, so all of it */
    word(&s, 0, 11, 4, 300); /* -dici: the same word */
    word(&s, 1, 1, 2, 400);
    word(&s, 1, 4, 1, 500);
    word(&s, 7, 0, 1, 600);
    finish(&s);
    assert_int_equal(s.u->word_count, 3);
    check_word(&s, 0, 0, 200, 3, 18);
    check_word(&s, 1, 200, 400, 20, 26);
    check_word(&s, 2, 400, 1000, 31, 33);
    assert_string_equal(s.u->words[0].text, "L'amìca");
    assert_string_equal(s.u->words[1].text, "dodici");
    assert_string_equal(s.u->words[2].text, "ur");
    assert_int_equal(s.u->warning_count, 1);
    size_t from, to;
    assert_true(voice_request_locate(&s.request, 0, 5, 1, &from, &to)); /* second byte of ì: all of it */
    assert_true(from == 14 && to == 16);
    assert_false(voice_request_locate(&s.request, 0, 99, 1, &from, &to));
    assert_false(voice_request_locate(&s.request, 0, 0, 0, &from, &to));
    end(&s);
}

static void places_marks(void **state) {
    (void)state;
    struct media_segment s = {.score = score_new()};
    struct error e;
    add_text(s.score, 0, "uno", true, NULL);
    score_add(s.score, SCORE_MARK, 3, 4)->text = "m";
    score_add(s.score, SCORE_BREAK, 4, 5)->seconds = 0.5;
    add_text(s.score, 5, "due", true, NULL);
    score_add(s.score, SCORE_MARK, 8, 9)->text = "m";
    score_add(s.score, SCORE_MARK, 9, 10)->text = "end";
    request(&s);
    assert_int_equal(s.request.span_count, 6);
    assert_float_equal(s.request.break_seconds, 0.5, 0);
    assert_int_equal(audio(&s, 1000, RATE, &e), 0);
    word(&s, 0, 0, 3, 0);
    word(&s, 3, 0, 3, 600);
    mark(&s, "other", 1);
    mark(&s, "m", 550);
    mark(&s, "m", 5000);
    finish(&s);
    assert_int_equal(s.u->mark_count, 3);
    assert_string_equal(s.u->marks[0].name, "m");
    assert_int_equal(s.u->marks[0].at, 550);
    assert_int_equal(s.u->marks[1].at, 1000);
    assert_string_equal(s.u->marks[2].name, "end");
    assert_int_equal(s.u->marks[2].at, 1000);
    assert_int_equal(s.u->warning_count, 2);
    end(&s);
}

/* A voice that reports no marks: the host places them at the start of the next word. */
static void places_marks_that_are_not_reported(void **state) {
    (void)state;
    struct media_segment s = {.score = score_new()};
    struct error e;
    add_text(s.score, 0, "uno", true, NULL);
    score_add(s.score, SCORE_MARK, 3, 4)->text = "a";
    add_text(s.score, 5, "due", true, NULL);
    score_add(s.score, SCORE_MARK, 8, 9)->text = "b";
    request(&s);
    assert_int_equal(audio(&s, 1000, RATE, &e), 0);
    word(&s, 0, 0, 3, 0);
    word(&s, 2, 0, 3, 600);
    finish(&s);
    assert_int_equal(s.u->marks[0].at, 600);
    assert_int_equal(s.u->marks[1].at, 1000);
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fills_gaps_with_pauses),
        cmocka_unit_test(mends_times_with_a_warning),
        cmocka_unit_test(nothing_said_is_one_pause),
        cmocka_unit_test(refuses_broken_audio),
        cmocka_unit_test(refuses_too_many_events),
        cmocka_unit_test(cuts_names_between_characters),
        cmocka_unit_test(keeps_words_without_phones),
        cmocka_unit_test(maps_words_to_the_input),
        cmocka_unit_test(places_marks),
        cmocka_unit_test(places_marks_that_are_not_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
