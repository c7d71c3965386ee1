/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/fuzz/fuzz.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Discards log lines: replaces server/base/log.c. */
void log_error(const char *format, ...) {
    (void)format;
}
const char *log_format_name(void) {
    return "text";
}
void log_warn(const char *format, ...) {
    (void)format;
}
void log_info(const char *format, ...) {
    (void)format;
}

void fuzz_fail(const char *file, int line, const char *condition) {
    fprintf(stderr, "%s:%d: this does not hold: %s\n", file, line, condition);
    abort();
}

uint8_t fuzz_u8(struct fuzz_input *in) {
    return in->at < in->end ? *in->at++ : 0;
}

uint16_t fuzz_u16(struct fuzz_input *in) {
    uint8_t low = fuzz_u8(in);
    return (uint16_t)(low | fuzz_u8(in) << 8);
}

uint32_t fuzz_u32(struct fuzz_input *in) {
    uint32_t low = fuzz_u16(in);
    return low | (uint32_t)fuzz_u16(in) << 16;
}

uint8_t *fuzz_bytes(struct fuzz_input *in, size_t *size) {
    if (*size > fuzz_left(in))
        *size = fuzz_left(in);
    uint8_t *copy = mem_alloc(*size);
    if (*size)
        memcpy(copy, in->at, *size);
    in->at += *size;
    return copy;
}

uint8_t *fuzz_rest(struct fuzz_input *in, size_t *size) {
    *size = fuzz_left(in);
    return fuzz_bytes(in, size);
}

static char *text(struct fuzz_input *in, size_t size) {
    char *copy = mem_strndup((const char *)in->at, size);
    in->at += size;
    return copy;
}

char *fuzz_line(struct fuzz_input *in) {
    const uint8_t *end = fuzz_left(in) ? memchr(in->at, '\n', fuzz_left(in)) : NULL;
    char *line = text(in, end ? (size_t)(end - in->at) : fuzz_left(in));
    if (end)
        in->at++;
    return line;
}

char *fuzz_rest_text(struct fuzz_input *in) {
    return text(in, fuzz_left(in));
}

static char folder[FUZZ_PATH / 2];

static void remove_folder(void) {
    char path[FUZZ_PATH + 256];
    struct dirent *entry;
    DIR *dir = opendir(folder);
    while (dir && (entry = readdir(dir))) {
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        unlink(path);
    }
    if (dir)
        closedir(dir);
    rmdir(folder);
}

const char *fuzz_folder(void) {
    if (*folder)
        return folder;
    snprintf(folder, sizeof folder, "%s/XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
    FUZZ_CHECK(mkdtemp(folder));
    atexit(remove_folder);
    return folder;
}

void fuzz_write(const char *name, const void *data, size_t size, char *path) {
    snprintf(path, FUZZ_PATH, "%s/%s", fuzz_folder(), name);
    FILE *file = fopen(path, "wb");
    FUZZ_CHECK(file && fwrite(data, 1, size, file) == size);
    fclose(file);
}

void fuzz_write_json(const char *name, const json_t *json, char *path) {
    char *written = json_dumps(json, JSON_COMPACT | JSON_ENCODE_ANY);
    FUZZ_CHECK(written);
    fuzz_write(name, written, strlen(written), path);
    free(written);
}

json_t *fuzz_load_json(const char *path) {
    char full[512];
    snprintf(full, sizeof full, SOURCE_ROOT "/%s", path);
    json_t *json = json_load_file(full, 0, NULL);
    FUZZ_CHECK(json);
    return json;
}
