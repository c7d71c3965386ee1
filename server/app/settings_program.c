/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which program has which settings. */
#include "server/app/settings_internal.h"
#include <string.h>

/* A worker has voices, and what they need. */
static bool is_of_worker(const char *path) {
    static const char *const others[] = {"voices.boundaries", "voices.cache_megabytes", "voices.cache_file",
                                         "voices.cache_file_megabytes"};
    static const char *const own[] = {"cluster.address", "limits.stop_seconds", "log.format", "paths.plugins",
                                      "paths.worker"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (!strcmp(path, others[i]))
            return false;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (!strcmp(path, own[i]))
            return true;
    return !strncmp(path, "voices.", strlen("voices."));
}

bool setting_is_of(enum program program, const struct setting *setting) {
    return program == PROGRAM_DAEMON ||
           (program == PROGRAM_WORKER ? is_of_worker(setting->path) : setting->program == FOR_BOTH);
}
