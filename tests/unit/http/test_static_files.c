/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of a folder, with and without their compressed forms. */
#include "server/http/static_files.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

enum { TEXT_BYTES = 4000 };

static void write_bytes(const char *folder, const char *name, const void *data, size_t size) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    fclose(file);
}

static void write_packed(const char *folder, const char *name, const void *data, size_t size) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    gzFile file = gzopen(path, "wb9");
    assert_non_null(file);
    assert_int_equal(gzwrite(file, data, (unsigned)size), size);
    gzclose(file);
}

/* Copies a packed file, less its last bytes or with its announced size changed. */
static void damage(const char *folder, const char *from, const char *to, size_t cut, int announced) {
    char path[256];
    uint8_t data[TEXT_BYTES];
    snprintf(path, sizeof path, "%s/%s", folder, from);
    FILE *file = fopen(path, "rb");
    size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    data[size - 4] = (uint8_t)(data[size - 4] + announced);
    write_bytes(folder, to, data, size - cut);
}

static void test_packed(void **state) {
    (void)state;
    char folder[] = "/tmp/faccia-static-XXXXXX", text[TEXT_BYTES], command[64];
    assert_non_null(mkdtemp(folder));
    memset(text, 'a', sizeof text);
    write_bytes(folder, "plain.html", text, sizeof text);
    write_bytes(folder, "both.html", text, sizeof text);
    write_packed(folder, "both.html.gz", text, sizeof text);
    write_packed(folder, "alone.html.gz", text, sizeof text);
    write_packed(folder, "index.html.gz", text, sizeof text);
    write_packed(folder, "unknown.xyz.gz", text, sizeof text);
    write_bytes(folder, "empty.html.gz", "", 0);
    write_bytes(folder, "text.html.gz", text, sizeof text);
    damage(folder, "alone.html.gz", "cut.html.gz", 9, 0);
    damage(folder, "alone.html.gz", "less.html.gz", 0, -1);
    damage(folder, "alone.html.gz", "more.html.gz", 0, 1);
    struct static_files files = {0};
    static_files_add_folder(&files, folder);
    assert_int_equal(files.count, 4);
    static const char *const found[] = {"/plain.html", "/both.html", "/alone.html", "/"};
    for (size_t i = 0; i < sizeof found / sizeof *found; i++) {
        const struct static_file *file = static_files_find(&files, found[i]);
        assert_non_null(file);
        assert_string_equal(file->type, "text/html; charset=utf-8");
        assert_int_equal(file->size, sizeof text);
        assert_memory_equal(file->data, text, sizeof text);
        assert_non_null(file->packed);
        assert_string_equal(file->hash, files.list[0]->hash);
    }
    static_files_free(&files);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_packed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
