/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/synthesis/recording.h"
#include "server/synthesis/recording_internal.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

bool recording_is_name(const char *name) {
    size_t size = strlen(name);
    bool fit = size && size <= RECORDING_NAME_BYTES_MAX && *name != '.' && !strchr(name, '/') &&
               utf8_check(name, size) == size;
    for (const char *c = name; *c; c++)
        fit &= (unsigned char)*c >= ' ';
    return fit;
}

static int is_fap(const struct dirent *entry) {
    size_t size = strlen(entry->d_name);
    return size > 4 && !strcmp(entry->d_name + size - 4, ".fap");
}

void recording_list(const char *folder, void (*each)(void *ctx, const char *name, bool sound), void *ctx) {
    struct dirent **entries;
    int count = scandir(folder, &entries, is_fap, alphasort);
    for (int i = 0; i < count; i++) {
        char *name = entries[i]->d_name, *sound = NULL;
        size_t size = strlen(folder) + strlen(name) + 2;
        char *path = mem_alloc(size);
        struct stat status;
        snprintf(path, size, "%s/%s", folder, name);
        name[strlen(name) - 4] = '\0';
        if (recording_is_name(name) && !stat(path, &status) && S_ISREG(status.st_mode)) {
            sound = recording_sound_beside(path);
            each(ctx, name, sound);
        }
        free(sound);
        free(path);
        free(entries[i]);
    }
    if (count >= 0)
        free(entries);
}
