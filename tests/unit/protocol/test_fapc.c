/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fapc/fapc.h"
#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { FRAMES = 12, CAP = (FRAMES + 1) * FAPC_FRAME_BYTES_MAX };

static json_t *vectors(const char *member) {
    json_error_t e;
    json_t *root = json_load_file(SOURCE_ROOT "/protocol/vectors/fapc.json", 0, &e);
    assert_non_null(root);
    json_t *part = json_incref(json_object_get(root, member));
    json_decref(root);
    return part;
}

static void set_bytes(struct fap_frame *frame, int n, uint8_t *out, const json_t *list) {
    size_t i;
    json_t *value;
    if (!list)
        return;
    frame->mask[0] |= (uint8_t)(1 << (n - 1));
    json_array_foreach((json_t *)list, i, value) out[i] = (uint8_t)json_integer_value(value);
}

static struct fap_frame frame_of(const json_t *object) {
    struct fap_frame frame = {0};
    uint8_t viseme[4] = {0}, expression[6] = {0};
    const char *key;
    json_t *value;
    json_object_foreach(json_object_get(object, "values"), key, value) {
        fap_frame_set(&frame, atoi(key), (int32_t)json_integer_value(value));
    }
    set_bytes(&frame, 1, viseme, json_object_get(object, "viseme"));
    set_bytes(&frame, 2, expression, json_object_get(object, "expression"));
    frame.viseme = (struct fap_viseme){viseme[0], viseme[1], viseme[2], viseme[3]};
    frame.expression = (struct fap_expression){expression[0], expression[1], expression[2],
                                               expression[3], expression[4], expression[5]};
    return frame;
}

static size_t bytes_of(const json_t *packet, uint8_t *out) {
    const char *hex = json_string_value(json_object_get(packet, "bytes"));
    size_t size = strlen(hex) / 2;
    for (size_t i = 0; i < size; i++)
        sscanf(hex + 2 * i, "%2hhx", &out[i]);
    return size;
}

static void assert_same(const struct fap_frame *a, const struct fap_frame *b) {
    assert_memory_equal(a->mask, b->mask, sizeof a->mask);
    assert_memory_equal(&a->viseme, &b->viseme, sizeof a->viseme);
    assert_memory_equal(&a->expression, &b->expression, sizeof a->expression);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(a, n))
            assert_int_equal(a->value[n], b->value[n]);
}

static void as_written_down(void **state) {
    (void)state;
    static uint8_t wanted[CAP], got[CAP];
    json_t *streams = vectors("streams"), *stream, *packet, *object;
    size_t s, p, i, packets = 0;
    json_array_foreach(streams, s, stream) {
        struct fapc_encoder encoder;
        struct fapc_decoder decoder;
        fapc_encoder_init(&encoder, (int)json_integer_value(json_object_get(stream, "quality")));
        fapc_decoder_init(&decoder);
        json_array_foreach(json_object_get(stream, "packets"), p, packet) {
            struct fap_frame frames[FRAMES], decoded[FRAMES];
            json_t *given = json_object_get(packet, "frames"), *expected = json_object_get(packet, "decoded");
            size_t count = json_array_size(given), size = bytes_of(packet, wanted);
            json_array_foreach(given, i, object) frames[i] = frame_of(object);
            assert_int_equal(fapc_encode(&encoder, frames, count,
                                         json_is_true(json_object_get(packet, "intra")), got, CAP),
                             size);
            assert_memory_equal(got, wanted, size);
            assert_null(fapc_decode(&decoder, wanted, size, decoded, count));
            json_array_foreach(expected, i, object) {
                struct fap_frame frame = frame_of(object);
                assert_same(&decoded[i], &frame);
            }
            packets++;
        }
    }
    assert_true(packets > 20);
    json_decref(streams);
}

static void refuses_the_bad_ones(void **state) {
    (void)state;
    static uint8_t first[CAP], bytes[CAP];
    json_t *streams = vectors("streams"), *bad = vectors("bad"), *entry;
    const json_t *packets = json_object_get(json_array_get(streams, 0), "packets");
    size_t i, first_size = bytes_of(json_array_get(packets, 0), first);
    assert_true(json_array_size(bad) >= 5);
    json_array_foreach(bad, i, entry) {
        struct fapc_decoder decoder;
        struct fap_frame frames[3];
        size_t size = bytes_of(entry, bytes);
        fapc_decoder_init(&decoder);
        assert_null(fapc_decode(&decoder, first, first_size, frames, 3));
        assert_non_null(fapc_decode(&decoder, bytes, size, frames, 3));
        /* refuses packets until the next starting point */
        size = bytes_of(json_array_get(packets, 1), bytes);
        assert_non_null(fapc_decode(&decoder, bytes, size, frames, 3));
        assert_null(fapc_decode(&decoder, first, first_size, frames, 3));
    }
    json_decref(bad);
    json_decref(streams);
}

static uint32_t random_bits(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static void wander(struct fap_frame *frame, uint32_t *seed) {
    for (int n = 3; n <= FAP_COUNT; n++)
        fap_frame_set(frame, n, fap_clamp(n, frame->value[n] + (int32_t)(random_bits(seed) % 61) - 30));
}

/* Values are within half a step; a lost packet is detected, and the next starting point recovers. */
static void error_and_loss(void **state) {
    (void)state;
    static uint8_t packet[CAP];
    for (int quality = 0; quality <= FAPC_QUALITY_MAX; quality += 3) {
        struct fapc_encoder encoder;
        struct fapc_decoder decoder;
        struct fap_frame now = {0}, out;
        uint32_t seed = (uint32_t)quality + 1;
        bool lost = false;
        fapc_encoder_init(&encoder, quality);
        fapc_decoder_init(&decoder);
        for (int p = 0; p < 300; p++) {
            wander(&now, &seed);
            bool intra = p % 50 == 0;
            size_t size = fapc_encode(&encoder, &now, 1, intra, packet, CAP);
            lost = (lost && !intra) || p % 70 == 33;
            if (p % 70 == 33)
                continue;
            const char *wrong = fapc_decode(&decoder, packet, size, &out, 1);
            assert_int_equal(wrong != NULL, lost);
            for (int n = 3; n <= FAP_COUNT && !wrong; n++)
                assert_true(abs(out.value[n] - now.value[n]) <= fapc_step(n, quality) / 2);
        }
    }
}

/* Damaged packets do no harm, and the next starting point decodes. */
static void damage(void **state) {
    (void)state;
    static uint8_t packet[CAP], broken[CAP];
    struct fapc_encoder encoder;
    struct fapc_decoder decoder;
    struct fap_frame now[3] = {0}, out[3];
    uint32_t seed = 7;
    unsigned refused = 0;
    fapc_encoder_init(&encoder, 5);
    fapc_decoder_init(&decoder);
    for (int p = 0; p < 20000; p++) {
        for (int i = 0; i < 3; i++)
            wander(&now[i], &seed);
        bool intra = p % 10 == 0;
        size_t size = fapc_encode(&encoder, now, 3, intra, packet, CAP);
        memcpy(broken, packet, size);
        size_t cut = p % 10 ? random_bits(&seed) % (size + 1) : size;
        for (int k = 0; p % 10 && k < 1 + (int)(random_bits(&seed) % 8) && cut; k++)
            broken[random_bits(&seed) % cut] = (uint8_t)random_bits(&seed);
        uint8_t *exact = malloc(cut ? cut : 1); /* the sanitizer detects overruns */
        memcpy(exact, broken, cut);
        const char *wrong = fapc_decode(&decoder, exact, cut, out, 3);
        free(exact);
        refused += wrong != NULL;
        assert_true(!intra || !wrong);
        for (int i = 0; i < 3 && !wrong; i++)
            for (int n = 3; n <= FAP_COUNT; n++)
                assert_true(abs(out[i].value[n]) <= FAPC_VALUE_MAX + 2 * fapc_step(n, FAPC_QUALITY_MAX));
    }
    assert_in_range(refused, 1000, 19000);
}

static void limits(void **state) {
    (void)state;
    static uint8_t packet[CAP];
    struct fapc_encoder encoder;
    struct fapc_decoder decoder;
    struct fap_frame frames[FRAMES] = {0};
    fapc_encoder_init(&encoder, 99);
    assert_int_equal(encoder.state.quality, FAPC_QUALITY_MAX);
    assert_int_equal(fapc_encode(&encoder, frames, 1, false, packet, 10), 0);
    assert_int_equal(fapc_encode(&encoder, frames, FAPC_FRAMES_MAX + 1, false, packet, CAP), 0);
    fapc_decoder_init(&decoder);
    assert_non_null(fapc_decode(&decoder, packet, 0, frames, 1));
    assert_non_null(fapc_decode(&decoder, (const uint8_t *)"\x80", 1, frames, 1));
    assert_non_null(fapc_decode(&decoder, (const uint8_t *)"\x80\x20", 2, frames, 1));
    assert_non_null(fapc_decode(&decoder, (const uint8_t *)"\x01", 1, frames, 1));
    /* 68 constant FAPs soon take a byte or two per packet */
    fapc_encoder_init(&encoder, 5);
    size_t size = 0;
    for (int n = 3; n <= FAP_COUNT; n++)
        fap_frame_set(&frames[0], n, 0);
    for (int i = 0; i < 60; i++)
        size = fapc_encode(&encoder, frames, 1, false, packet, CAP);
    assert_true(size <= 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_written_down), cmocka_unit_test(refuses_the_bad_ones),
        cmocka_unit_test(error_and_loss),  cmocka_unit_test(damage),
        cmocka_unit_test(limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
