/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the chunk codec with the vectors shared with the JavaScript codec. */
#include "protocol/chunk/chunk.h"
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

static void check_chunk(const json_t *v, const struct chunk *c, const struct fap_frame *frames) {
    const json_t *audio = json_object_get(v, "audio"), *expected = json_object_get(v, "frames");
    assert_int_equal(c->utterance, integer(v, "utterance"));
    assert_int_equal(c->sample_rate, integer(v, "rate"));
    assert_int_equal(c->fps_hundreds, integer(v, "fps_hundreds"));
    assert_int_equal(c->start, integer(v, "start"));
    assert_int_equal(c->samples, integer(v, "samples"));
    assert_int_equal(c->first_frame, integer(v, "first_frame"));
    assert_int_equal(c->audio_bytes, 2 * json_array_size(audio));
    for (size_t i = 0; i < json_array_size(audio); i++)
        assert_int_equal((int16_t)(c->audio[2 * i] | c->audio[2 * i + 1] << 8),
                         json_integer_value(json_array_get(audio, i)));
    assert_int_equal(c->frame_count, json_array_size(expected));
    for (size_t k = 0; k < c->frame_count; k++)
        check_frame(json_array_get(expected, k), &frames[k]);
}

/* exact: the encoder must produce these bytes; loose vectors only decode. */
static void codes_vectors(const char *list, bool exact) {
    size_t i;
    json_t *v;
    json_array_foreach(json_object_get(vectors, list), i, v) {
        static uint8_t bytes[BYTES_MAX], again[BYTES_MAX];
        struct fap_frame frames[FRAMES_MAX];
        struct chunk c;
        size_t at, size = bytes_of(v, bytes);
        assert_null(chunk_decode(bytes, size, &c, frames, FRAMES_MAX, &at));
        check_chunk(v, &c, frames);
        size_t length = chunk_encode(&c, frames, again, sizeof again);
        if (exact) {
            assert_int_equal(length, size);
            assert_memory_equal(again, bytes, size);
        } else {
            assert_in_range(length, CHUNK_HEADER_BYTES, size - 1);
        }
    }
    assert_true(i > 1);
}

static void codes_the_good_vectors(void **state) {
    (void)state;
    codes_vectors("good", true);
}

static void decodes_the_loose_vectors(void **state) {
    (void)state;
    codes_vectors("loose", false);
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
        const char *wrong = chunk_decode(bytes, size, &c, frames, FRAMES_MAX, &at);
        if (!wrong || (json_int_t)at != integer(v, "at"))
            fail_msg("%s: byte %zu, %s", json_string_value(json_object_get(v, "name")), at,
                     wrong ? wrong : "no error");
    }
    assert_true(i > 10);
}

static void decodes_as_many_frames_as_there_is_room_for(void **state) {
    (void)state;
    static uint8_t bytes[BYTES_MAX];
    const json_t *good = json_object_get(vectors, "good");
    const json_t *walk = json_array_get(good, json_array_size(good) - 1);
    size_t at, size = bytes_of(walk, bytes), count = json_array_size(json_object_get(walk, "frames"));
    struct fap_frame all[FRAMES_MAX], some[FRAMES_MAX];
    struct chunk c;
    assert_null(chunk_decode(bytes, size, &c, all, FRAMES_MAX, &at));
    for (size_t cap = 0; cap <= count; cap++) {
        memset(some, 0x55, sizeof some);
        assert_null(chunk_decode(bytes, size, &c, cap ? some : NULL, cap, &at));
        assert_int_equal(c.frame_count, count);
        assert_memory_equal(some, all, cap * sizeof *some);
        assert_int_equal(some[cap].value[3], 0x55555555);
    }
}

static uint32_t next_random(uint32_t *seed) {
    *seed = *seed * 1664525 + 1013904223;
    return *seed >> 8;
}

/* Everything that decodes can be encoded again with the same meaning. */
static void check_round_trip(const struct chunk *c, const struct fap_frame *frames, size_t size) {
    struct fap_frame again[FRAMES_MAX];
    struct chunk d;
    size_t at, room = size + 1;
    uint8_t *bytes = malloc(room);
    size_t length = chunk_encode(c, frames, bytes, room);
    assert_in_range(length, CHUNK_HEADER_BYTES, size);
    assert_null(chunk_decode(bytes, length, &d, again, FRAMES_MAX, &at));
    assert_int_equal(d.frame_count, c->frame_count);
    assert_memory_equal(again, frames, c->frame_count * sizeof *frames);
    free(bytes);
}

static void survives_any_bytes(void **state) {
    (void)state;
    const json_t *good = json_object_get(vectors, "good");
    uint32_t seed = 1;
    size_t accepted = 0, refused = 0;
    for (size_t round = 0; round < 20000; round++) {
        static uint8_t bytes[BYTES_MAX];
        struct fap_frame frames[FRAMES_MAX];
        struct chunk c;
        size_t at, size = bytes_of(json_array_get(good, round % json_array_size(good)), bytes);
        for (size_t hit = 0; hit < 1 + round % 5; hit++) {
            uint32_t where = next_random(&seed);
            bytes[where % (hit % 2 ? CHUNK_HEADER_BYTES : size)] = (uint8_t)next_random(&seed);
        }
        if (round % 7 == 0)
            size = next_random(&seed) % (size + 1);
        uint8_t *exact = malloc(size ? size : 1); /* the sanitizer detects overruns */
        memcpy(exact, bytes, size);
        if (chunk_decode(exact, size, &c, frames, FRAMES_MAX, &at)) {
            assert_in_range(at, 0, size);
            refused++;
        } else {
            if (c.frame_count <= FRAMES_MAX)
                check_round_trip(&c, frames, size);
            accepted++;
        }
        free(exact);
    }
    assert_true(accepted > 1000 && refused > 1000); /* the damage is neither harmless nor always fatal */
}

static const uint8_t two_samples[4];
static const struct chunk fine = {.audio_codec = CHUNK_AUDIO_PCM_S16LE,
                                  .fap_codec = CHUNK_FAP_PLAIN,
                                  .sample_rate = 8000,
                                  .fps_hundreds = 2500,
                                  .frame_count = 2,
                                  .samples = 2,
                                  .audio_bytes = 4,
                                  .audio = two_samples};

static void leaves_out_what_the_mask_leaves_out(void **state) {
    (void)state;
    uint8_t a[256], b[256];
    struct fap_frame frames[2] = {0}, noisy[2];
    memset(noisy, 0x66, sizeof noisy);
    for (int k = 0; k < 2; k++) {
        memset(noisy[k].mask, 0, sizeof noisy[k].mask);
        fap_frame_set(&frames[k], 7, 70 + k);
        fap_frame_set(&noisy[k], 7, 70 + k);
    }
    size_t size = chunk_encode(&fine, frames, a, sizeof a);
    assert_int_equal(size, CHUNK_HEADER_BYTES + 4 + 2 * FAP_MASK_BYTES + 2 + 1);
    assert_int_equal(chunk_encode(&fine, noisy, b, sizeof b), size);
    assert_memory_equal(a, b, size);
}

static void needs_no_more_room_than_stated(void **state) {
    (void)state;
    struct fap_frame frames[2];
    uint8_t out[CHUNK_HEADER_BYTES + 4 + 2 * CHUNK_FRAME_BYTES_MAX];
    memset(frames, 0xFF, sizeof frames);
    for (int n = 3; n <= FAP_COUNT; n++) {
        frames[0].value[n] = INT32_MIN;
        frames[1].value[n] = 0;
    }
    memset(&frames[1].viseme, 1, sizeof frames[1].viseme);
    memset(&frames[1].expression, 1, sizeof frames[1].expression);
    assert_int_equal(chunk_encode(&fine, frames, out, sizeof out), sizeof out);
    for (size_t cap = 0; cap < sizeof out; cap++)
        assert_int_equal(chunk_encode(&fine, frames, out, cap), 0);
}

static void refuses_to_encode_nonsense(void **state) {
    (void)state;
    uint8_t out[4096];
    struct fap_frame frames[2] = {0};
    struct chunk c[] = {fine, fine, fine, fine, fine, fine, fine};
    assert_true(chunk_encode(&fine, frames, out, sizeof out) > 0);
    c[0].audio_bytes = 3;
    c[1].audio_codec = CHUNK_AUDIO_SILENCE;
    c[2].audio_codec = 9;
    c[3].sample_rate = 0;
    c[4].fps_hundreds = 0;
    c[5].fap_codec = CHUNK_FAP_NONE;
    c[6].fap_codec = 9;
    for (size_t i = 0; i < sizeof c / sizeof *c; i++)
        assert_int_equal(chunk_encode(&c[i], frames, out, sizeof out), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(codes_the_good_vectors),
        cmocka_unit_test(decodes_the_loose_vectors),
        cmocka_unit_test(says_where_the_bad_vectors_break),
        cmocka_unit_test(decodes_as_many_frames_as_there_is_room_for),
        cmocka_unit_test(survives_any_bytes),
        cmocka_unit_test(leaves_out_what_the_mask_leaves_out),
        cmocka_unit_test(needs_no_more_room_than_stated),
        cmocka_unit_test(refuses_to_encode_nonsense),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
