/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests packed events with the vectors shared with the JavaScript code. */
#include "protocol/chunk/compact.h"
#include "protocol/chunk/packed.h"
#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { BYTES_MAX = 4096 };

static json_t *vectors;

static int setup(void **state) {
    (void)state;
    vectors = json_load_file(SOURCE_ROOT "/protocol/vectors/packed.json", 0, NULL);
    return vectors ? 0 : -1;
}

static int teardown(void **state) {
    (void)state;
    json_decref(vectors);
    return 0;
}

/* Allocates exactly the size, so that the sanitizer detects overruns. */
static uint8_t *bytes_of(const json_t *vector, const char *name, size_t *size) {
    const char *hex = json_string_value(json_object_get(vector, name));
    *size = strlen(hex) / 2;
    uint8_t *out = malloc(*size);
    for (size_t i = 0; i < *size; i++) {
        unsigned byte;
        sscanf(hex + 2 * i, "%2x", &byte);
        out[i] = (uint8_t)byte;
    }
    return out;
}

static uint32_t integer(const json_t *object, const char *name) {
    return (uint32_t)json_integer_value(json_object_get(object, name));
}

static void check_event(const json_t *expected, const struct packed_event *e) {
    static const char *const names[] = {"sentence", "word", "mark", "phone"};
    static const char *const texts[] = {"text", "text", "name", "ipa"};
    const char *text = json_string_value(json_object_get(expected, texts[e->kind]));
    assert_string_equal(json_string_value(json_object_get(expected, "type")), names[e->kind]);
    assert_int_equal(integer(expected, "sample"), e->sample);
    assert_true(e->duration / 22050.0 - json_number_value(json_object_get(expected, "duration")) < 1e-6);
    assert_int_equal(integer(expected, "start"), e->start);
    assert_int_equal(integer(expected, "utf16_start"), e->utf16_start);
    assert_int_equal(strlen(text), e->size);
    assert_memory_equal(text, e->text, e->size);
}

/* Reads the events of a chunk, compares them with expected ones, and encodes them again. */
static const char *read_all(const struct chunk *chunk, const json_t *expected, uint8_t *again, size_t *size) {
    const uint8_t *at = chunk->events, *end = at + chunk->events_bytes;
    for (size_t i = 0; at < end; i++) {
        struct packed_event e;
        const char *wrong = packed_read(&at, end, &e);
        if (wrong)
            return wrong;
        if (expected)
            check_event(json_array_get(expected, i), &e);
        *size += packed_write(&e, again + *size);
    }
    return NULL;
}

static void test_good(void **state) {
    (void)state;
    size_t i;
    json_t *vector;
    json_array_foreach(json_object_get(vectors, "good"), i, vector) {
        struct compact reader = {0}, writer = {0};
        struct chunk chunk;
        const uint8_t *fap;
        uint8_t again[BYTES_MAX], header[COMPACT_HEADER_BYTES_MAX];
        size_t fap_size, size = 0, total, packed_size;
        uint8_t *bytes = bytes_of(vector, "hex", &total), *packed = bytes_of(vector, "packed", &packed_size);
        assert_null(compact_read(&reader, bytes, total, &chunk, &fap, &fap_size));
        assert_int_equal(fap_size, 0);
        assert_null(read_all(&chunk, json_object_get(vector, "events"), again, &size));
        assert_int_equal(size, packed_size);
        assert_memory_equal(again, packed, size);
        size_t head = compact_write(&writer, &chunk, true, header);
        assert_int_equal(head + size, total);
        assert_memory_equal(header, bytes, head);
        free(bytes);
        free(packed);
    }
    assert_true(i > 4);
}

static void test_bad(void **state) {
    (void)state;
    size_t i;
    json_t *vector;
    json_array_foreach(json_object_get(vectors, "bad"), i, vector) {
        struct compact reader = {0};
        struct chunk chunk;
        const uint8_t *fap;
        uint8_t again[BYTES_MAX];
        size_t fap_size, size = 0, total;
        uint8_t *bytes = bytes_of(vector, "hex", &total);
        const char *wrong = compact_read(&reader, bytes, total, &chunk, &fap, &fap_size);
        if (!wrong)
            wrong = read_all(&chunk, NULL, again, &size);
        if (!wrong)
            fail_msg("%s is read", json_string_value(json_object_get(vector, "name")));
        free(bytes);
    }
    assert_true(i > 4);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_good), cmocka_unit_test(test_bad)};
    return cmocka_run_group_tests(tests, setup, teardown);
}
