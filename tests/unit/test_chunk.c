/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The chunk codec against the vectors that the JavaScript codec is held to as well. */
#include "protocol/chunk.h"
#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { BYTES_MAX = 65536, FRAMES_MAX = 64 };

static json_t *vectors;

static int setup(void **state) {
    (void)state;
    vectors = json_load_file(SOURCE_ROOT "/protocol/vectors/chunks.json", 0, NULL);
    return vectors ? 0 : -1;
}

static int teardown(void **state) {
    (void)state;
    json_decref(vectors);
    return 0;
}

static json_int_t integer(const json_t *object, const char *name) {
    return json_integer_value(json_object_get(object, name));
}

static size_t bytes_of(const json_t *vector, uint8_t *out) {
    const char *hex = json_string_value(json_object_get(vector, "hex"));
    size_t size = strlen(hex) / 2;
    for (size_t i = 0; i < size; i++) {
        unsigned byte;
        sscanf(hex + 2 * i, "%2x", &byte);
        out[i] = (uint8_t)byte;
    }
    return size;
}

static void check_bytes(const json_t *list, const uint8_t *bytes) {
    for (size_t i = 0; i < json_array_size(list); i++)
        assert_int_equal(json_integer_value(json_array_get(list, i)), bytes[i]);
}

static void check_frame(const json_t *expected, const struct fap_frame *frame) {
    const json_t *values = json_object_get(expected, "values");
    for (int n = 3; n <= FAP_COUNT; n++) {
        char name[8];
        snprintf(name, sizeof name, "%d", n);
        assert_int_equal(frame->value[n], (int32_t)integer(values, name));
    }
    check_bytes(json_object_get(expected, "viseme"), (const uint8_t *)&frame->viseme);
    check_bytes(json_object_get(expected, "expression"), (const uint8_t *)&frame->expression);
}

static void codes_the_good_vectors(void **state) {
    (void)state;
    size_t i;
    json_t *v;
    json_array_foreach(json_object_get(vectors, "good"), i, v) {
        static uint8_t bytes[BYTES_MAX], again[BYTES_MAX];
        struct fap_frame frames[FRAMES_MAX];
        struct chunk c;
        size_t at, size = bytes_of(v, bytes);
        assert_null(chunk_decode(bytes, size, &c, frames, FRAMES_MAX, &at));
        assert_int_equal(c.utterance, integer(v, "utterance"));
        assert_int_equal(c.sample_rate, integer(v, "rate"));
        assert_int_equal(c.fps_hundreds, integer(v, "fps_hundreds"));
        assert_int_equal(c.start, integer(v, "start"));
        assert_int_equal(c.samples, integer(v, "samples"));
        assert_int_equal(c.first_frame, integer(v, "first_frame"));
        assert_int_equal(c.audio_bytes, 2 * json_array_size(json_object_get(v, "audio")));
        assert_int_equal(c.frame_count, json_array_size(json_object_get(v, "frames")));
        for (unsigned k = 0; k < c.frame_count; k++)
            check_frame(json_array_get(json_object_get(v, "frames"), k), &frames[k]);
        assert_int_equal(chunk_encode(&c, frames, again, sizeof again), size);
        assert_memory_equal(again, bytes, size);
    }
    assert_true(i > 5);
}

static void says_where_the_bad_vectors_break(void **state) {
    (void)state;
    size_t i;
    json_t *v;
    json_array_foreach(json_object_get(vectors, "bad"), i, v) {
        static uint8_t bytes[BYTES_MAX];
        struct fap_frame frames[FRAMES_MAX];
        struct chunk c;
        size_t at = 9999, size = bytes_of(v, bytes);
        assert_non_null(chunk_decode(bytes, size, &c, frames, FRAMES_MAX, &at));
        assert_int_equal(at, integer(v, "at"));
    }
    assert_true(i > 10);
}

static void survives_any_bytes(void **state) {
    (void)state;
    uint32_t random = 1;
    for (int round = 0; round < 20000; round++) {
        const json_t *good = json_object_get(vectors, "good");
        static uint8_t bytes[BYTES_MAX];
        struct fap_frame frames[4];
        struct chunk c;
        size_t at, size = bytes_of(json_array_get(good, (size_t)round % json_array_size(good)), bytes);
        for (int hit = 0; hit < 1 + round % 5; hit++) {
            random = random * 1664525 + 1013904223;
            bytes[random / 7 % size] = (uint8_t)(random >> 24);
        }
        uint8_t *exact = malloc(size); /* so that the sanitizer sees a step too far */
        memcpy(exact, bytes, size);
        const char *wrong = chunk_decode(exact, size - random % 3, &c, frames, 4, &at);
        assert_true(!wrong || at <= size);
        free(exact);
    }
}

static void refuses_to_encode_nonsense(void **state) {
    (void)state;
    uint8_t out[4096];
    struct fap_frame frame = {0};
    const uint8_t audio[4] = {0};
    const struct chunk fine = {.audio_codec = CHUNK_AUDIO_PCM_S16LE, .fap_codec = CHUNK_FAP_PLAIN, .sample_rate = 8000,
                               .fps_hundreds = 2500, .frame_count = 1, .samples = 2, .audio_bytes = 4, .audio = audio};
    assert_true(chunk_encode(&fine, &frame, out, sizeof out) > 0);
    assert_int_equal(chunk_encode(&fine, &frame, out, 40), 0);
    struct chunk c = fine;
    c.audio_bytes = 3;
    assert_int_equal(chunk_encode(&c, &frame, out, sizeof out), 0);
    c = fine;
    c.sample_rate = 0;
    assert_int_equal(chunk_encode(&c, &frame, out, sizeof out), 0);
    c = fine;
    c.fap_codec = CHUNK_FAP_NONE;
    assert_int_equal(chunk_encode(&c, &frame, out, sizeof out), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(codes_the_good_vectors),
        cmocka_unit_test(says_where_the_bad_vectors_break),
        cmocka_unit_test(survives_any_bytes),
        cmocka_unit_test(refuses_to_encode_nonsense),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
