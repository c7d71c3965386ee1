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

int setting_was_renamed(const char *name, struct error *e) {
    return error_in_field(
        e, ERROR_BAD_FIELD, name,
        "the file of secrets that sign tokens is named by --secret-file (FACCIA_SECRET_FILE, "
        "access.secret_file); --token-file is what the programs beside the daemon call a file "
        "with a token in it");
}

bool setting_is_of(enum program program, const struct setting *setting) {
    return program == PROGRAM_DAEMON ||
           (program == PROGRAM_WORKER ? is_of_worker(setting->path) : setting->program == FOR_BOTH);
}
