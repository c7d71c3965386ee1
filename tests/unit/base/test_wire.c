/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/wire.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Copies a payload to memory of exactly its size, so that the sanitizer detects overruns. */
static struct wire_frame exact(const uint8_t *data, size_t size) {
    uint8_t *copy = malloc(size ? size : 1);
    if (size)
        memcpy(copy, data, size);
    return (struct wire_frame){.data = copy, .size = size};
}

static void frames_come_whole_or_not_at_all(void **state) {
    (void)state;
    struct buf b = {0};
    struct wire_frame frame;
    size_t used = 0, place = wire_begin(&b, WIRE_CANCEL, 7);
    wire_end(&b, place);
    place = wire_begin(&b, WIRE_HELLO, 0);
    wire_put_string(&b, "ciao");
    wire_end(&b, place);
    for (size_t size = 0; size < WIRE_HEADER_BYTES; size++)
        assert_int_equal(wire_next(b.data, size, &frame, &used), 0);
    assert_int_equal(wire_next(b.data, b.size, &frame, &used), 1);
    assert_int_equal(frame.type, WIRE_CANCEL);
    assert_int_equal(frame.job, 7);
    assert_int_equal(frame.size, 0);
    assert_int_equal(used, WIRE_HEADER_BYTES);
    assert_int_equal(wire_next(b.data + used, b.size - used - 1, &frame, &used), 0);
    assert_int_equal(wire_next(b.data + used, b.size - used, &frame, &used), 1);
    struct wire_reader r = wire_read(&frame);
    assert_string_equal(wire_get_string(&r), "ciao");
    assert_false(r.bad);
    buf_free(&b);
}

static void refuses_impossible_headers(void **state) {
    (void)state;
    struct wire_frame frame;
    size_t used;
    const uint32_t too_long[] = {WIRE_PAYLOAD_MAX + 1, WIRE_AUDIO, 1}, no_type[] = {0, 0, 1},
                   unknown[] = {0, WIRE_TYPE_END, 1};
    assert_int_equal(wire_next((const uint8_t *)too_long, sizeof too_long, &frame, &used), -1);
    assert_int_equal(wire_next((const uint8_t *)no_type, sizeof no_type, &frame, &used), -1);
    assert_int_equal(wire_next((const uint8_t *)unknown, sizeof unknown, &frame, &used), -1);
}

static const struct faccia_span spans[] = {
    {.kind = FACCIA_SPAN_TEXT,
     .text = "Perché?",
     .lang = "it",
     .phones = "perˈke",
     .say_as = "digits",
     .emotion = "joy",
     .intensity = 0.5,
     .rate = 160,
     .pitch = 1.25,
     .range = 0.75,
     .volume = 2,
     .emphasis = 4},
    {.kind = FACCIA_SPAN_BREAK, .seconds = 0.25},
    {.kind = FACCIA_SPAN_MARK, .text = ""},
};

static struct buf sentence_payload(void) {
    struct buf b = {0};
    wire_put_sentence(&b, &(struct faccia_sentence){.voice = "it+f2", .spans = spans, .span_count = 3});
    return b;
}

static void a_sentence_comes_back(void **state) {
    (void)state;
    struct buf b = sentence_payload();
    struct wire_frame frame = exact(b.data, b.size);
    struct wire_reader r = wire_read(&frame);
    struct faccia_sentence sentence;
    struct faccia_span *read;
    assert_true(wire_get_sentence(&r, &sentence, &read));
    assert_string_equal(sentence.voice, "it+f2");
    assert_int_equal(sentence.span_count, 3);
    assert_string_equal(read[0].text, "Perché?");
    assert_string_equal(read[0].lang, "it");
    assert_string_equal(read[0].phones, "perˈke");
    assert_string_equal(read[0].say_as, "digits");
    assert_string_equal(read[0].emotion, "joy");
    assert_float_equal(read[0].intensity, 0.5, 0);
    assert_float_equal(read[0].rate, 160, 0);
    assert_float_equal(read[0].pitch, 1.25, 0);
    assert_float_equal(read[0].range, 0.75, 0);
    assert_float_equal(read[0].volume, 2, 0);
    assert_int_equal(read[0].emphasis, 4);
    assert_int_equal(read[1].kind, FACCIA_SPAN_BREAK);
    assert_null(read[1].text);
    assert_float_equal(read[1].seconds, 0.25, 0);
    assert_int_equal(read[2].kind, FACCIA_SPAN_MARK);
    assert_string_equal(read[2].text, "");
    assert_null(sentence.before);
    assert_null(sentence.after);
    free(read);
    free((void *)frame.data);
    buf_free(&b);
}

static void the_text_around_comes_back(void **state) {
    (void)state;
    static const char *const cases[][2] = {{"Prima.", "Poi."}, {"Prima.", NULL}, {NULL, "Poi."}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct buf b = {0};
        const struct faccia_sentence told = {
            .voice = "a", .spans = spans, .span_count = 3, .before = cases[i][0], .after = cases[i][1]};
        wire_put_sentence(&b, &told);
        struct wire_frame frame = exact(b.data, b.size);
        struct wire_reader r = wire_read(&frame);
        struct faccia_sentence sentence;
        struct faccia_span *read;
        assert_true(wire_get_sentence(&r, &sentence, &read));
        for (int after = 0; after < 2; after++) {
            const char *is = after ? sentence.after : sentence.before;
            assert_true(is ? cases[i][after] && !strcmp(is, cases[i][after]) : !cases[i][after]);
        }
        free(read);
        free((void *)frame.data);
        buf_free(&b);
    }
}

/* Truncated or with a byte changed, it is refused or still a sentence; nothing outside is read. */
static void a_broken_sentence_does_no_harm(void **state) {
    (void)state;
    struct buf b = sentence_payload();
    struct faccia_sentence sentence;
    struct faccia_span *read;
    for (size_t size = 0; size < b.size; size++) {
        struct wire_frame frame = exact(b.data, size);
        struct wire_reader r = wire_read(&frame);
        assert_false(wire_get_sentence(&r, &sentence, &read));
        free(read);
        free((void *)frame.data);
    }
    for (size_t i = 0; i < b.size; i++) {
        struct wire_frame frame = exact(b.data, b.size);
        struct wire_reader r = wire_read(&frame);
        ((uint8_t *)frame.data)[i] ^= 0xFF;
        if (wire_get_sentence(&r, &sentence, &read))
            for (size_t k = 0; k < sentence.span_count; k++)
                assert_true(read[k].kind == FACCIA_SPAN_BREAK || read[k].text);
        free(read);
        free((void *)frame.data);
    }
    buf_free(&b);
}

static void events_come_back(void **state) {
    (void)state;
    struct buf b = {0};
    wire_put_event(&b, &(struct wire_event){.kind = WIRE_PHONE, .phone = {"t͡ʃ", "tS", 5, UINT64_MAX, 2}});
    wire_put_event(&b, &(struct wire_event){.kind = WIRE_WORD, .word = {3, 9, SIZE_MAX, 1, 2}});
    wire_put_event(&b, &(struct wire_event){.kind = WIRE_MARK, .text = "here", .at = 77});
    wire_put_event(&b, &(struct wire_event){.kind = WIRE_WARNING, .text = NULL});
    struct wire_frame frame = exact(b.data, b.size);
    struct wire_reader r = wire_read(&frame);
    struct wire_event e;
    assert_true(wire_get_event(&r, &e));
    assert_string_equal(e.phone.ipa, "t͡ʃ");
    assert_string_equal(e.phone.symbol, "tS");
    assert_true(e.phone.start == 5 && e.phone.end == UINT64_MAX && e.phone.stress == 2);
    assert_true(wire_get_event(&r, &e));
    assert_true(e.word.span == 3 && e.word.offset == 9 && e.word.bytes == SIZE_MAX);
    assert_true(e.word.start == 1 && e.word.end == 2);
    assert_true(wire_get_event(&r, &e));
    assert_string_equal(e.text, "here");
    assert_true(e.at == 77);
    assert_true(wire_get_event(&r, &e));
    assert_string_equal(e.text, "");
    assert_false(wire_get_event(&r, &e));
    assert_false(r.bad);
    free((void *)frame.data);
    for (size_t size = 1; size < b.size; size++) {
        frame = exact(b.data, size);
        r = wire_read(&frame);
        while (wire_get_event(&r, &e))
            continue;
        assert_true(r.bad || r.at == r.end);
        free((void *)frame.data);
    }
    buf_free(&b);
}

static void a_string_must_end_where_it_says(void **state) {
    (void)state;
    const struct {
        uint32_t length;
        char bytes[4];
    } inside = {3, "a\0b"}, beyond = {4, "abc"};
    struct wire_frame frame = {.data = (const uint8_t *)&inside, .size = 8};
    struct wire_reader r = wire_read(&frame);
    assert_null(wire_get_string(&r));
    assert_true(r.bad);
    frame.data = (const uint8_t *)&beyond;
    r = wire_read(&frame);
    assert_null(wire_get_string(&r));
    assert_true(r.bad);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_come_whole_or_not_at_all), cmocka_unit_test(refuses_impossible_headers),
        cmocka_unit_test(a_sentence_comes_back),           cmocka_unit_test(the_text_around_comes_back),
        cmocka_unit_test(a_broken_sentence_does_no_harm),  cmocka_unit_test(events_come_back),
        cmocka_unit_test(a_string_must_end_where_it_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
