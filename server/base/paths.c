/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/paths.h"
#include "server/base/mem.h"
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The first of the candidates, each relative to the program's folder, that exists. */
static char *find(const char *variable, const char *folder, const char *const *candidates) {
    const char *given = getenv(variable);
    if (given && *given)
        return mem_strdup(given);
    for (; *candidates; candidates++) {
        char path[PATH_MAX], real[PATH_MAX];
        int length = snprintf(path, sizeof path, "%s/%s", folder, *candidates);
        if (length > 0 && (size_t)length < sizeof path && realpath(path, real))
            return mem_strdup(real);
    }
    return mem_strdup("");
}

void paths_find(struct paths *paths) {
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length < 0 ? 0 : length] = '\0';
    const char *folder = dirname(program);
    /* build tree (build/server/app/PROGRAM), then an installed prefix (bin/PROGRAM) */
    paths->models =
        find("FACCIA_MODELS", folder, (const char *const[]){"../../models", "../share/faccia/models", NULL});
    paths->web = find("FACCIA_WEB", folder, (const char *const[]){"../../web", "../share/faccia/web", NULL});
    paths->plugins =
        find("FACCIA_PLUGINS", folder, (const char *const[]){"../plugins", "../lib/faccia/plugins", NULL});
    paths->worker = find("FACCIA_WORKER", folder,
                         (const char *const[]){"../voice/faccia-voice", "../lib/faccia/faccia-voice", NULL});
    paths->voice_config = find("FACCIA_VOICE_CONFIG", folder, (const char *const[]){NULL});
}

void paths_free(struct paths *paths) {
    free(paths->models);
    free(paths->web);
    free(paths->plugins);
    free(paths->worker);
    free(paths->voice_config);
    *paths = (struct paths){0};
}
