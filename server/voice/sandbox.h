/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a worker process takes from itself before its plugin is loaded, on Linux, in four layers:
 * - namespaces: no rights of an administrator, no other machine's and no other process's shared memory;
 * without FACCIA_VOICE_NETWORK a network of its own, in which there is nothing;
 * - memory: others of the same user cannot read it or write to it, nor it theirs;
 * - files (Landlock): what it may read and write (sandbox_files.c); no signals to processes outside;
 * - system calls (seccomp; sandbox_calls.c).
 * Threads and programs that are started later have no more. Rights once lost do not come back, not by a
 * set-user-ID program either (no_new_privs). */
#ifndef FACCIA_VOICE_SANDBOX_H
#define FACCIA_VOICE_SANDBOX_H

#include "server/voice/plugin_needs.h"
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

struct sandbox_path {
    const char *path;
    bool write;
};

struct sandbox {
    const char *plugin; /* its file: it may read what lies beside it */
    const struct needs *needs;
    const struct sandbox_path *paths; /* that the operator allows */
    size_t path_count;
    pid_t daemon;
};

/* What could not be had: sentences, empty when all was. */
struct sandbox_gaps {
    char spaces[160], files[160], calls[160];
};

/* Called while the process has one thread. */
void sandbox_enter(const struct sandbox *sandbox, struct sandbox_gaps *gaps);

#endif
