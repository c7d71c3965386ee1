/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the fuzz targets share. A target is one function that takes any bytes; libFuzzer calls it with those
 * that it makes up, replay.c with those of files. */
#ifndef FACCIA_TESTS_FUZZ_H
#define FACCIA_TESTS_FUZZ_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What must hold for any input. */
#define FUZZ_CHECK(condition)                                                                                \
    do                                                                                                       \
        if (!(condition))                                                                                    \
            fuzz_fail(__FILE__, __LINE__, #condition);                                                       \
    while (0)
_Noreturn void fuzz_fail(const char *file, int line, const char *condition);

/* The input as it is used up. Where it is at its end, there are zeros. */
struct fuzz_input {
    const uint8_t *at, *end;
};
static inline struct fuzz_input fuzz_input(const uint8_t *data, size_t size) {
    return (struct fuzz_input){data, data + size};
}
static inline size_t fuzz_left(const struct fuzz_input *in) {
    return (size_t)(in->end - in->at);
}
uint8_t fuzz_u8(struct fuzz_input *in);
uint16_t fuzz_u16(struct fuzz_input *in);
uint32_t fuzz_u32(struct fuzz_input *in);

/* 0 <= result < count */
static inline size_t fuzz_below(struct fuzz_input *in, size_t count) {
    return fuzz_u8(in) % count;
}

/* A copy of exactly size bytes, so that a sanitizer sees what is read beyond it; or fewer at the end. */
uint8_t *fuzz_bytes(struct fuzz_input *in, size_t *size);
uint8_t *fuzz_rest(struct fuzz_input *in, size_t *size);

/* A string: up to the next line's end, or all that is left. NULs in it end it. */
char *fuzz_line(struct fuzz_input *in);
char *fuzz_rest_text(struct fuzz_input *in);

/* A folder for this process's files, in $TMPDIR; it is removed at the end. */
const char *fuzz_folder(void);
/* Writes a file in it. path has FUZZ_PATH bytes. */
enum { FUZZ_PATH = 256 };
void fuzz_write(const char *name, const void *data, size_t size, char *path);
void fuzz_write_json(const char *name, const json_t *json, char *path);

/* json_edit.c: a copy of the value, changed as the bytes say; any bytes say something. */
json_t *fuzz_edit_json(const json_t *json, struct fuzz_input *in);

/* A file below the top of the source tree, read once and kept by the caller. */
json_t *fuzz_load_json(const char *path);

#endif
