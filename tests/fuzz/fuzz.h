/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the fuzz targets. A target is one function that takes any bytes: from libFuzzer, or from files
 * through replay.c. */
#ifndef FACCIA_TESTS_FUZZ_H
#define FACCIA_TESTS_FUZZ_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Aborts if the condition is false. */
#define FUZZ_CHECK(condition)                                                                                \
    do                                                                                                       \
        if (!(condition))                                                                                    \
            fuzz_fail(__FILE__, __LINE__, #condition);                                                       \
    while (0)
_Noreturn void fuzz_fail(const char *file, int line, const char *condition);

/* Reads the input piece by piece, followed by zeros. */
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

/* Returns a copy of exactly size bytes, fewer at the end, so that a sanitizer detects reads beyond it. */
uint8_t *fuzz_bytes(struct fuzz_input *in, size_t *size);
uint8_t *fuzz_rest(struct fuzz_input *in, size_t *size);

/* Returns a string up to the end of the line or of the input. It ends at the first NUL. */
char *fuzz_line(struct fuzz_input *in);
char *fuzz_rest_text(struct fuzz_input *in);

/* Returns a folder in $TMPDIR for this process's files, which is removed at exit. */
const char *fuzz_folder(void);
/* Writes a file to that folder. path has FUZZ_PATH bytes. */
enum { FUZZ_PATH = 256 };
void fuzz_write(const char *name, const void *data, size_t size, char *path);
void fuzz_write_json(const char *name, const json_t *json, char *path);

/* json_edit.c: returns a copy of the value, edited by the bytes; any bytes are valid. */
json_t *fuzz_edit_json(const json_t *json, struct fuzz_input *in);

/* Returns a file below the top of the source tree, read once and owned by the caller. */
json_t *fuzz_load_json(const char *path);

#endif
