/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fapfile.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A mask line with the given FAPs set. */
static char *mask(char *out, const int *faps) {
    for (int n = 1; n <= FAP_COUNT; n++)
        out[2 * n - 2] = '0', out[2 * n - 1] = n < FAP_COUNT ? ' ' : '\0';
    for (; *faps; faps++)
        out[2 * *faps - 2] = '1';
    return out;
}

#define MASK(...) mask((char[2 * FAP_COUNT]){0}, (const int[]){__VA_ARGS__, 0})

static struct fapfile file;
static struct fapfile_error error;

static int read_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

static int read_text(const char *format, ...) {
    char text[8192];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    char *exact = malloc((size_t)length + 1);
    memcpy(exact, text, (size_t)length);
    int result = fapfile_read(exact, (size_t)length, &file, &error);
    free(exact);
    return result;
}

static void reads_version_2_1(void **state) {
    (void)state;
    assert_int_equal(read_text("2.1 marco 25 2\n%s\n0 100 -20\n%s\n1 7\n", MASK(3, 5), MASK(68)), 0);
    assert_string_equal(file.version, "2.1");
    assert_string_equal(file.name, "marco");
    assert_true(file.fps == 25);
    assert_int_equal(file.count, 2);
    assert_int_equal(file.frames[0].value[3], 100);
    assert_int_equal(file.frames[0].value[5], -20);
    assert_true(fap_frame_has(&file.frames[0], 5));
    assert_false(fap_frame_has(&file.frames[0], 68));
    assert_int_equal(file.frames[1].value[68], 7);
    fapfile_free(&file);
}

static void reads_what_is_found_in_the_wild(void **state) {
    (void)state;
    assert_int_equal(read_text("# made by hand\r\n2.0 C:\\my files\\a face.wav 29.97 1\r\n%s\r\n0 -inf 5\r\n", MASK(3, 4)), 0);
    assert_string_equal(file.version, "2.0");
    assert_string_equal(file.name, "C:\\my files\\a face.wav");
    assert_true(file.fps == 29.97);
    assert_int_equal(file.frames[0].value[3], 0);
    assert_int_equal(file.frames[0].value[4], 5);
    fapfile_free(&file);

    assert_int_equal(read_text("%s\n0 12\n\n%s \n1\n", MASK(3), MASK(0)), 0); /* no header, an empty frame */
    assert_string_equal(file.version, "");
    assert_true(file.fps == 25);
    assert_int_equal(file.count, 2);
    fapfile_free(&file);

    assert_int_equal(read_text("2.1 a 25 1\n%s\n0 1 10 63 0 3 40 0 0 1 1 -9", MASK(1, 2, 3)), 0);
    assert_int_equal(file.frames[0].viseme.select2, 10);
    assert_int_equal(file.frames[0].viseme.blend, 63);
    assert_int_equal(file.frames[0].expression.select1, 3);
    assert_int_equal(file.frames[0].expression.intensity1, 40);
    assert_int_equal(file.frames[0].expression.def, 1);
    assert_int_equal(file.frames[0].value[3], -9);
    fapfile_free(&file);
}

static void fails_at(size_t line, size_t column) {
    if (error.line != line || error.column != column)
        fail_msg("%zu:%zu %s", error.line, error.column, error.message);
}

static void names_line_and_column(void **state) {
    (void)state;
    assert_int_equal(read_text("%s", ""), -1);
    fails_at(1, 1);
    assert_int_equal(read_text("hello world\n"), -1);
    fails_at(1, 1);
    assert_int_equal(read_text("2.1 a 25\n"), -1);
    fails_at(1, 9);
    assert_int_equal(read_text("2.1 a fast 2\n"), -1);
    fails_at(1, 7);
    assert_int_equal(read_text("2.1 a 25 x\n"), -1);
    fails_at(1, 10);
    assert_int_equal(read_text("2.1 a 25 1\n0 1 0\n0\n"), -1);
    fails_at(2, 6);
    assert_int_equal(read_text("2.1 a 25 1\n%s 1\n0\n", MASK(3)), -1);
    fails_at(2, 137);
    assert_int_equal(read_text("2.1 a 25 1\n%.4s 2 %s\n0\n", MASK(3), MASK(3)), -1);
    fails_at(2, 6);
    assert_int_equal(read_text("2.1 a 25 1\n%s\n", MASK(3)), -1);
    fails_at(3, 1);
    assert_int_equal(read_text("2.1 a 25 1\n%s\n0\n", MASK(3)), -1);
    fails_at(3, 2);
    assert_int_equal(read_text("2.1 a 25 1\n%s\n0 x\n", MASK(3)), -1);
    fails_at(3, 3);
    assert_int_equal(read_text("2.1 a 25 1\n%s\n0 5 5\n", MASK(3)), -1);
    fails_at(3, 5);
    assert_int_equal(read_text("2.1 a 25 1\n%s\n0 99999999999\n", MASK(3)), -1);
    fails_at(3, 3);
    assert_int_equal(read_text("2.1 a 25 1\n%s\n0 1 2 300 4\n", MASK(1)), -1);
    fails_at(3, 7);
    assert_int_equal(read_text("2.1 a 25 2\n%s\n0 5\n", MASK(3)), -1);
    fails_at(4, 1);
}

static void writes_what_it_reads(void **state) {
    (void)state;
    struct fap_frame frame = {.viseme = {1, 2, 30, 0}, .expression = {4, 50, 0, 0, 0, 1}};
    char text[4096];
    frame.mask[0] = 3;
    for (int n = 3; n <= FAP_COUNT; n++)
        fap_frame_set(&frame, n, n * 1000 - 30000);
    size_t length = fapfile_write_header("una prova", 29.97, 1, text, sizeof text);
    assert_string_equal(text, "2.1 una prova 29.97 1\n");
    size_t frame_length = fapfile_write_frame(&frame, 0, NULL, 0);
    assert_int_equal(fapfile_write_frame(&frame, 0, text + length, sizeof text - length), frame_length);
    assert_int_equal(strlen(text), length + frame_length);
    assert_int_equal(fapfile_read(text, length + frame_length, &file, &error), 0);
    assert_string_equal(file.name, "una prova");
    assert_memory_equal(&file.frames[0], &frame, sizeof frame);
    fapfile_free(&file);
}

static void survives_any_text(void **state) {
    (void)state;
    char good[1024], text[1024];
    snprintf(good, sizeof good, "2.1 a b 25 2\n%s\n0 1 2 3 4 5 6 7 8 9 10 11\n%s\n1 7\n", MASK(1, 2, 3), MASK(68));
    uint32_t random = 7;
    for (int round = 0; round < 20000; round++) {
        size_t length = strlen(good);
        memcpy(text, good, length);
        for (int hit = 0; hit < 1 + round % 4; hit++) {
            random = random * 1664525 + 1013904223;
            text[random / 7 % length] = "0123456789 -+.\n\r\t#e\0x"[(random >> 16) % 21];
        }
        char *exact = malloc(length);
        memcpy(exact, text, length);
        if (!fapfile_read(exact, length - random % 9, &file, &error))
            fapfile_free(&file);
        free(exact);
    }
}

static void knows_the_faps(void **state) {
    (void)state;
    static const int sizes[] = {2, 16, 12, 8, 4, 5, 3, 10, 4, 4};
    int groups[11] = {0};
    for (int n = 1; n <= FAP_COUNT; n++) {
        assert_int_equal(fap_by_name(fap_table[n].name), n);
        groups[fap_table[n].group]++;
    }
    for (int g = 1; g <= 10; g++)
        assert_int_equal(groups[g], sizes[g - 1]);
    assert_int_equal(fap_by_name("open_mouth"), 0);
    assert_int_equal(fap_clamp(3, -1), 0);
    assert_int_equal(fap_clamp(5, -100000), -3720);
    assert_int_equal(fap_table[49].unit, FAP_UNIT_AU);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_version_2_1),
        cmocka_unit_test(reads_what_is_found_in_the_wild),
        cmocka_unit_test(names_line_and_column),
        cmocka_unit_test(writes_what_it_reads),
        cmocka_unit_test(survives_any_text),
        cmocka_unit_test(knows_the_faps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
