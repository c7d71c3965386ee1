/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a target on the named files and on the files of named folders, for builds without libFuzzer. */
#include "server/base/buf.h"
#include "tests/fuzz/fuzz.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t replay_file(const char *path) {
    struct buf input = {0};
    FILE *file = fopen(path, "rb");
    for (size_t got = 1; file && got;) {
        got = fread(buf_reserve(&input, 65536), 1, 65536, file);
        input.size += got;
    }
    if (!file)
        return 0;
    fclose(file);
    uint8_t *exact = malloc(input.size ? input.size : 1); /* so that a sanitizer detects reads beyond it */
    if (input.size)
        memcpy(exact, input.data, input.size);
    fprintf(stderr, "%s\n", path);
    LLVMFuzzerTestOneInput(exact, input.size);
    free(exact);
    buf_free(&input);
    return 1;
}

static size_t replay(const char *path) {
    struct dirent **entries;
    int count = scandir(path, &entries, NULL, alphasort);
    size_t done = 0;
    if (count < 0)
        return replay_file(path);
    for (int i = 0; i < count; i++) {
        char file[4096];
        snprintf(file, sizeof file, "%s/%s", path, entries[i]->d_name);
        if (*entries[i]->d_name != '.')
            done += replay_file(file);
        free(entries[i]);
    }
    free(entries);
    return done;
}

int main(int argc, char **argv) {
    size_t done = 0;
    for (int i = 1; i < argc; i++)
        done += replay(argv[i]);
    printf("ok 1 - %zu inputs\n", done);
    return !done;
}
