/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A .fap file. Valid files are written and read again. */
#include "protocol/fapfile.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_MAX = 16384 };

static void add_text(struct buf *out, const char *text, size_t size) {
    FUZZ_CHECK(size < TEXT_MAX);
    buf_add(out, text, size);
}

static void write_all(const struct fapfile *file, struct buf *out) {
    char *text = mem_alloc(TEXT_MAX);
    size_t size = fapfile_write_header("again", file->fps, file->count, text, TEXT_MAX);
    add_text(out, text, size);
    for (size_t i = 0; i < file->count; i++)
        add_text(out, text, fapfile_write_frame(&file->frames[i], i, text, TEXT_MAX));
    free(text);
}

static void check_same(const struct fap_frame *a, const struct fap_frame *b) {
    FUZZ_CHECK(!memcmp(a->mask, b->mask, sizeof a->mask));
    for (int n = 3; n <= FAP_COUNT; n++)
        FUZZ_CHECK(!fap_frame_has(a, n) || a->value[n] == b->value[n]);
    FUZZ_CHECK(!fap_frame_has(a, 1) || !memcmp(&a->viseme, &b->viseme, sizeof a->viseme));
    FUZZ_CHECK(!fap_frame_has(a, 2) || !memcmp(&a->expression, &b->expression, sizeof a->expression));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fapfile file, again;
    struct fapfile_error e = {0};
    if (fapfile_read((const char *)data, size, &file, &e)) {
        FUZZ_CHECK(e.message && e.line && e.column);
        return 0;
    }
    FUZZ_CHECK(file.fps > 0 && file.fps <= FAPFILE_FPS_MAX && file.name);
    struct buf out = {0};
    write_all(&file, &out);
    FUZZ_CHECK(!fapfile_read((char *)out.data, out.size, &again, &e));
    FUZZ_CHECK(again.count == file.count);
    for (size_t i = 0; i < file.count; i++)
        check_same(&file.frames[i], &again.frames[i]);
    fapfile_free(&again);
    fapfile_free(&file);
    buf_free(&out);
    return 0;
}
