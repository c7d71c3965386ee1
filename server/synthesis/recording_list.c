/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/open_below.h"
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

static int is_fap(const struct dirent *entry) {
    size_t size = strlen(entry->d_name);
    return size > 4 && !strcmp(entry->d_name + size - 4, ".fap");
}

void recording_list(const char *folder, bool (*each)(void *ctx, const char *name, bool sound), void *ctx) {
    struct dirent **entries;
    int count = scandir(folder, &entries, is_fap, alphasort);
    bool wanted = true;
    for (int i = 0; i < count; i++) {
        char *name = entries[i]->d_name;
        FILE *file = wanted ? open_file_below(folder, name) : NULL;
        int sound = file ? recording_sound_beside(folder, name) : -1;
        name[strlen(name) - 4] = '\0';
        if (file && recording_is_name(name))
            wanted = each(ctx, name, sound >= 0);
        if (file)
            fclose(file);
        if (sound >= 0)
            close(sound);
        free(entries[i]);
    }
    if (count >= 0)
        free(entries);
}
