/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading and writing .fap text: against the samples of protocol/vectors/fap, whose contents fap.json tells.
 */
#include "protocol/fapfile.h"
#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define VECTORS SOURCE_ROOT "/protocol/vectors/"

static json_t *catalogue;

static int setup(void **state) {
    (void)state;
    catalogue = json_load_file(VECTORS "fap.json", 0, NULL);
    return catalogue ? 0 : -1;
}

static int teardown(void **state) {
    (void)state;
    json_decref(catalogue);
    return 0;
}

/* Loads a sample into a block of exactly its size, so that the sanitizer detects overruns. */
static char *load(const char *name, size_t *size) {
    char path[1024];
    snprintf(path, sizeof path, VECTORS "fap/%s", name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size ? *size : 1);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static void check_bytes(const json_t *frame, const char *name, bool there, const void *found) {
    const json_t *list = json_object_get(frame, name);
    assert_int_equal(list != NULL, there);
    for (size_t i = 0; i < json_array_size(list); i++)
        assert_int_equal(json_integer_value(json_array_get(list, i)), ((const uint8_t *)found)[i]);
}

static void check_frame(const json_t *expected, const struct fap_frame *frame) {
    const json_t *values = json_object_get(expected, "values");
    check_bytes(expected, "viseme", fap_frame_has(frame, 1), &frame->viseme);
    check_bytes(expected, "expression", fap_frame_has(frame, 2), &frame->expression);
    for (int n = 3; n <= FAP_COUNT; n++) {
        char name[8];
        snprintf(name, sizeof name, "%d", n);
        const json_t *value = json_object_get(values, name);
        assert_int_equal(fap_frame_has(frame, n), value != NULL);
        assert_int_equal(frame->value[n], json_integer_value(value));
    }
}

static void check_file(const json_t *expected, const struct fapfile *file) {
    const json_t *frames = json_object_get(expected, "frames");
    assert_string_equal(file->version, json_string_value(json_object_get(expected, "version")));
    assert_string_equal(file->name, json_string_value(json_object_get(expected, "name")));
    assert_true(file->fps == json_number_value(json_object_get(expected, "fps")));
    assert_int_equal(file->count, json_array_size(frames));
    for (size_t i = 0; i < file->count; i++)
        check_frame(json_array_get(frames, i), &file->frames[i]);
    const json_t *note = json_object_get(expected, "note");
    assert_int_equal(file->note.message != NULL, note != NULL);
    assert_int_equal(file->note.line, json_integer_value(json_object_get(note, "line")));
    assert_int_equal(file->note.column, json_integer_value(json_object_get(note, "column")));
    if (note)
        assert_string_equal(file->note.message, "69 flags, the last is ignored");
}

static void reads_the_samples(void **state) {
    (void)state;
    size_t i, good = 0, bad = 0;
    json_t *entry;
    json_array_foreach(catalogue, i, entry) {
        const char *name = json_string_value(json_object_get(entry, "file"));
        const json_t *place = json_object_get(entry, "error");
        size_t size;
        char *text = load(name, &size);
        struct fapfile file = {.count = 77};
        struct fapfile_error error = {0};
        int result = fapfile_read(text, size, &file, &error);
        free(text);
        if (result != (place ? -1 : 0))
            fail_msg("%s: %d %zu:%zu %s", name, result, error.line, error.column,
                     result ? error.message : "no error");
        if (!place) {
            check_file(entry, &file);
            fapfile_free(&file);
            good++;
            continue;
        }
        assert_int_equal(file.count, 77);
        if ((json_int_t)error.line != json_integer_value(json_object_get(place, "line")) ||
            (json_int_t)error.column != json_integer_value(json_object_get(place, "column")))
            fail_msg("%s: %zu:%zu %s", name, error.line, error.column, error.message);
        bad++;
    }
    assert_true(good > 15 && bad > 20);
}

/* Writes the file as version 2.1 into a block of exactly its size. */
static char *print(const struct fapfile *file, size_t *size) {
    size_t at = fapfile_write_header(file->name, file->fps, file->count, NULL, 0);
    for (size_t i = 0; i < file->count; i++)
        at += fapfile_write_frame(&file->frames[i], i, NULL, 0);
    char *text = malloc(at + 1);
    *size = at;
    at = fapfile_write_header(file->name, file->fps, file->count, text, *size + 1);
    for (size_t i = 0; i < file->count; i++)
        at += fapfile_write_frame(&file->frames[i], i, text + at, *size + 1 - at);
    assert_int_equal(at, *size);
    assert_int_equal(strlen(text), *size);
    return text;
}

/* Checks that a written file reads back as the same. */
static void check_round_trip(const struct fapfile *file) {
    struct fapfile again;
    struct fapfile_error error;
    size_t size;
    char *text = print(file, &size);
    if (fapfile_read(text, size, &again, &error))
        fail_msg("%zu:%zu %s in\n%s", error.line, error.column, error.message, text);
    assert_int_equal(again.count, file->count);
    if (file->count)
        assert_memory_equal(again.frames, file->frames, file->count * sizeof *file->frames);
    fapfile_free(&again);
    free(text);
}

static void writes_what_it_reads(void **state) {
    (void)state;
    size_t i, size;
    json_t *entry;
    json_array_foreach(catalogue, i, entry) {
        if (json_object_get(entry, "error"))
            continue;
        char *text = load(json_string_value(json_object_get(entry, "file")), &size);
        struct fapfile file;
        struct fapfile_error error;
        assert_int_equal(fapfile_read(text, size, &file, &error), 0);
        check_round_trip(&file);
        fapfile_free(&file);
        free(text);
    }
}

static bool stop_at_zero(void *ctx) {
    size_t *lines = ctx;
    return !(*lines)--;
}

static void stops_when_told(void **state) {
    (void)state;
    size_t size;
    char *text = load("all-faps.fap", &size);
    struct fapfile whole, file;
    struct fapfile_error error;
    assert_int_equal(fapfile_read(text, size, &whole, &error), 0);
    size_t lines = 1 + 2 * whole.count;
    for (size_t n = 0; n < lines; n++) { /* from the first frame's line on; checks that everything is freed */
        size_t left = n;
        assert_int_equal(fapfile_read_until(text, size, stop_at_zero, &left, &file, &error), -1);
        assert_string_equal(error.message, "stopped");
    }
    size_t never = SIZE_MAX / 2;
    assert_int_equal(fapfile_read_until(text, size, stop_at_zero, &never, &file, &error), 0);
    assert_int_equal(file.count, whole.count);
    fapfile_free(&file);
    fapfile_free(&whole);
    free(text);
}

static void writes_version_2_1(void **state) {
    (void)state;
    size_t size;
    char *sample = load("all-faps.fap", &size);
    struct fapfile file;
    struct fapfile_error error;
    assert_int_equal(fapfile_read(sample, size, &file, &error), 0);
    size_t length;
    char *text = print(&file, &length);
    assert_int_equal(length, size);
    assert_memory_equal(text, sample, size);
    fapfile_free(&file);
    free(text);
    free(sample);
}

static void assert_header(const char *name, double fps, size_t count, const char *expected) {
    char text[256];
    assert_int_equal(fapfile_write_header(name, fps, count, text, sizeof text), strlen(expected));
    assert_string_equal(text, expected);
}

static void writes_headers(void **state) {
    (void)state;
    assert_header("una prova", 25, 3, "2.1 una prova 25 3\n");
    assert_header("a", 29.97, 0, "2.1 a 29.97 0\n");
    assert_header("a", 30000 / 1001.0, 1, "2.1 a 29.97003 1\n");
    assert_header("a", 0.5, 1, "2.1 a 0.5 1\n");
    assert_header("a", 12.05, 1, "2.1 a 12.05 1\n");
    assert_header("two\nlines\r\t1", 25, 1, "2.1 two lines  1 25 1\n");
}

static void prints_into_any_room(void **state) {
    (void)state;
    struct fap_frame frame = {.viseme = {1, 2, 30, 0}};
    char whole[512], part[512];
    fap_frame_set(&frame, 1, 0);
    fap_frame_set(&frame, 68, INT32_MIN);
    size_t length = fapfile_write_frame(&frame, 12, whole, sizeof whole);
    assert_int_equal(length, strlen(whole));
    assert_string_equal(whole + 135, "\n12 1 2 30 0 -2147483648\n");
    for (size_t cap = 1; cap <= length + 1; cap++) {
        memset(part, '~', sizeof part);
        assert_int_equal(fapfile_write_frame(&frame, 12, part, cap), length);
        assert_int_equal(strlen(part), cap - 1);
        assert_memory_equal(part, whole, cap - 1);
        assert_int_equal(part[cap], '~');
    }
}

static uint32_t next_random(uint32_t *seed) {
    *seed = *seed * 1664525 + 1013904223;
    return *seed >> 8;
}

/* Overwrites characters, removes parts, truncates. Returns the new size. */
static size_t damage(char *text, size_t size, uint32_t *seed) {
    for (uint32_t hits = 1 + next_random(seed) % 4; hits && size; hits--) {
        size_t at = next_random(seed) % size, length = next_random(seed) % (size - at) % 40;
        switch (next_random(seed) % 4) {
        case 0:
            memmove(text + at, text + at + length, size - at - length);
            size -= length;
            break;
        case 1:
            if (next_random(seed) % 4 == 0)
                size = at;
            break;
        default:
            text[at] = "0123456789 -+.\n\r\t#einf\0\xFF"[next_random(seed) % 25];
        }
    }
    return size;
}

static void survives_any_text(void **state) {
    (void)state;
    uint32_t seed = 7;
    size_t size, accepted = 0, refused = 0;
    for (size_t i = 0; i < json_array_size(catalogue); i++) {
        char *sample = load(json_string_value(json_object_get(json_array_get(catalogue, i), "file")), &size);
        for (int round = 0; round < 400; round++) {
            char *text = malloc(size + 1);
            memcpy(text, sample, size);
            size_t rest = damage(text, size, &seed);
            char *exact = malloc(rest ? rest : 1);
            memcpy(exact, text, rest);
            struct fapfile file;
            struct fapfile_error error;
            if (!fapfile_read(exact, rest, &file, &error)) {
                check_round_trip(&file);
                fapfile_free(&file);
                accepted++;
            } else {
                assert_in_range(error.line, 1, rest + 1);
                assert_in_range(error.column, 1, rest + 1);
                refused++;
            }
            free(exact);
            free(text);
        }
        free(sample);
    }
    assert_true(accepted > 1000 && refused > 1000); /* the damage is neither harmless nor always fatal */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_the_samples),    cmocka_unit_test(writes_what_it_reads),
        cmocka_unit_test(writes_version_2_1),   cmocka_unit_test(writes_headers),
        cmocka_unit_test(prints_into_any_room), cmocka_unit_test(survives_any_text),
        cmocka_unit_test(stops_when_told),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
