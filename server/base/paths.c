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

/* Locations of the files in a build tree and below a prefix. A moved tree, or one staged for a package
 * (DESTDIR), is found from its programs. */
enum place { MODELS, WEB, PLUGINS, WORKER, ALIGNER, READER, RECOGNISER, COMMANDS, PLACES };

static const struct layout {
    const char *programs[3]; /* folders of programs; NULL = no more */
    const char *places[PLACES];
} layouts[] = {
    {{"server/daemon", "server/cli", "server/voice"},
     {"models", "web", "server/plugins", "server/voice/faccia-voice", "server/library/faccia-align",
      "server/daemon/faccia-reader", "server/live/faccia-recogniser", "server/cli/faccia"}},
    {{FACCIA_BINDIR, FACCIA_LIBDIR "/faccia"},
     {FACCIA_DATADIR "/faccia/models", FACCIA_DATADIR "/faccia/web", FACCIA_LIBDIR "/faccia/plugins",
      FACCIA_LIBDIR "/faccia/faccia-voice", FACCIA_LIBDIR "/faccia/faccia-align",
      FACCIA_LIBDIR "/faccia/faccia-reader", FACCIA_LIBDIR "/faccia/faccia-recogniser",
      FACCIA_BINDIR "/faccia"}},
};

enum { INSTALLED = 1 };

/* Removes the programs' folder from the end of the path, if it is there. */
static bool cut(char *path, const char *folder) {
    size_t length = strlen(path), part = strlen(folder);
    if (length <= part || path[length - part - 1] != '/' || strcmp(path + length - part, folder) != 0)
        return false;
    path[length - part - 1] = '\0';
    return true;
}

/* Detects the layout, and sets root to the folder that its locations are relative to. */
static const struct layout *look_round(char *root, size_t cap) {
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length < 0 ? 0 : length] = '\0';
    const char *folder = dirname(program);
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++)
        for (size_t k = 0; k < 3 && layouts[i].programs[k]; k++) {
            snprintf(root, cap, "%s", folder);
            if (cut(root, layouts[i].programs[k]))
                return &layouts[i];
        }
    snprintf(root, cap, "%s", FACCIA_PREFIX);
    return &layouts[INSTALLED];
}

static char *find(const char *root, const char *place) {
    char path[2 * PATH_MAX], real[PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", *place == '/' ? "" : root, place);
    return mem_strdup(realpath(path, real) ? real : "");
}

void paths_find(struct paths *paths) {
    char root[PATH_MAX];
    const struct layout *layout = look_round(root, sizeof root);
    paths->models = find(root, layout->places[MODELS]);
    paths->web = find(root, layout->places[WEB]);
    paths->plugins = find(root, layout->places[PLUGINS]);
    paths->worker = find(root, layout->places[WORKER]);
    paths->aligner = find(root, layout->places[ALIGNER]);
    paths->reader = find(root, layout->places[READER]);
    paths->recogniser = find(root, layout->places[RECOGNISER]);
    paths->commands = find(root, layout->places[COMMANDS]);
}

void paths_free(struct paths *paths) {
    free(paths->models);
    free(paths->web);
    free(paths->plugins);
    free(paths->worker);
    free(paths->aligner);
    free(paths->reader);
    free(paths->recogniser);
    free(paths->commands);
    *paths = (struct paths){0};
}
