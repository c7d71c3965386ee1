/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/paths.h"
#include "server/base/mem.h"
#include <libgen.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Where the programs lie in a build tree and below a prefix, and beside them the rest. A tree that was moved,
 * or staged for a package (DESTDIR), is found by its programs. */
enum place { MODELS, WEB, PLUGINS, WORKER, PLACES };

static const struct layout {
    const char *programs[2]; /* facciad and faccia; faccia-voice */
    const char *places[PLACES];
} layouts[] = {
    {{"server/app", "server/voice"}, {"models", "web", "server/plugins", "server/voice/faccia-voice"}},
    {{FACCIA_BINDIR, FACCIA_LIBDIR "/faccia"},
     {FACCIA_DATADIR "/faccia/models", FACCIA_DATADIR "/faccia/web", FACCIA_LIBDIR "/faccia/plugins",
      FACCIA_LIBDIR "/faccia/faccia-voice"}},
};

enum { INSTALLED = 1 };

/* Cuts the programs' folder off, if it is the last part of the path. */
static bool cut(char *path, const char *folder) {
    size_t length = strlen(path), part = strlen(folder);
    if (length <= part || path[length - part - 1] != '/' || strcmp(path + length - part, folder) != 0)
        return false;
    path[length - part - 1] = '\0';
    return true;
}

/* The layout, and in root the folder that its places are relative to. */
static const struct layout *look_round(char *root, size_t cap) {
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length < 0 ? 0 : length] = '\0';
    const char *folder = dirname(program);
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++)
        for (size_t k = 0; k < 2; k++) {
            snprintf(root, cap, "%s", folder);
            if (cut(root, layouts[i].programs[k]))
                return &layouts[i];
        }
    snprintf(root, cap, "%s", FACCIA_PREFIX);
    return &layouts[INSTALLED];
}

static char *find(const char *variable, const char *root, const char *place) {
    const char *given = getenv(variable);
    char path[2 * PATH_MAX], real[PATH_MAX];
    if (given && *given)
        return mem_strdup(given);
    snprintf(path, sizeof path, "%s/%s", *place == '/' ? "" : root, place);
    return mem_strdup(realpath(path, real) ? real : "");
}

void paths_find(struct paths *paths) {
    char root[PATH_MAX];
    const struct layout *layout = look_round(root, sizeof root);
    const char *configured = getenv("FACCIA_VOICE_CONFIG");
    paths->models = find("FACCIA_MODELS", root, layout->places[MODELS]);
    paths->web = find("FACCIA_WEB", root, layout->places[WEB]);
    paths->plugins = find("FACCIA_PLUGINS", root, layout->places[PLUGINS]);
    paths->worker = find("FACCIA_WORKER", root, layout->places[WORKER]);
    paths->voice_config = mem_strdup(configured ? configured : "");
}

void paths_free(struct paths *paths) {
    free(paths->models);
    free(paths->web);
    free(paths->plugins);
    free(paths->worker);
    free(paths->voice_config);
    *paths = (struct paths){0};
}
