/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Commands that run a tool of Node.js, which starts this program with its models. */
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int run_tool(const struct settings *settings, const char *tool, int argc, char **argv) {
    enum { ADDED = 4 };
    char self[4096] = {0}, faccia[] = "--faccia", models[] = "--models",
         *folder = mem_strdup(settings->models);
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    char **words = mem_alloc(((size_t)argc + ADDED) * sizeof *words);
    if (length <= 0)
        snprintf(self, sizeof self, "%s", "faccia");
    memcpy(words, (char *[ADDED]){faccia, self, models, folder}, ADDED * sizeof *words);
    memcpy(words + ADDED, argv + 1, (size_t)(argc - 1) * sizeof *words);
    int status = cli_run_tool(settings, tool, argv[0], argc - 1 + ADDED, words);
    free(words);
    free(folder);
    return status;
}

/* faccia speaker: aligns, measures and fits films. */
int speaker_main(int argc, char **argv, const struct settings *settings) {
    return run_tool(settings, "lips/faccia-speaker", argc, argv);
}

/* faccia session: makes the page of a recording session, and cuts its takes. */
int session_main(int argc, char **argv, const struct settings *settings) {
    return run_tool(settings, "session/faccia-session", argc, argv);
}
