/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/beneath.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/synthesis/recording.h"
#include "server/synthesis/recording_internal.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool recording_is_name(const char *name) {
    size_t size = strlen(name);
    bool fit = size && size <= RECORDING_NAME_BYTES_MAX && *name != '.' && !strchr(name, '/') &&
               utf8_check(name, size) == size;
    for (const char *c = name; *c; c++)
        fit &= (unsigned char)*c >= ' ';
    return fit;
}

struct names {
    char **names;
    size_t count, cap;
};

static int compare(const void *a, const void *b) {
    return strcoll(*(char *const *)a, *(char *const *)b);
}

/* The names that end in ".fap", in order. */
static void find(struct names *n, const char *folder, struct work_limit *limit) {
    DIR *dir = opendir(folder);
    while (dir && !work_limit_over(limit)) {
        const struct dirent *entry = readdir(dir);
        size_t size = entry ? strlen(entry->d_name) : 0;
        if (!entry)
            break;
        if (size <= 4 || strcmp(entry->d_name + size - 4, ".fap") != 0)
            continue;
        n->names = mem_grow(n->names, &n->cap, n->count + 1, sizeof *n->names);
        n->names[n->count++] = mem_strdup(entry->d_name);
    }
    if (dir)
        closedir(dir);
    if (n->count && !work_limit_over(limit))
        qsort(n->names, n->count, sizeof *n->names, compare);
}

bool recording_list(const char *folder, struct work_limit *limit,
                    void (*each)(void *ctx, const char *name, bool sound), void *ctx) {
    struct names n = {0};
    find(&n, folder, limit);
    for (size_t i = 0; i < n.count; i++) {
        char *name = n.names[i];
        bool wanted = !work_limit_over(limit);
        FILE *file = wanted ? beneath_file(folder, name) : NULL;
        int sound = file ? recording_sound_beside(folder, name) : -1;
        name[strlen(name) - 4] = '\0';
        if (file && recording_is_name(name))
            each(ctx, name, sound >= 0);
        if (file)
            fclose(file);
        if (sound >= 0)
            close(sound);
        free(name);
    }
    free(n.names);
    return !work_limit_over(limit);
}
