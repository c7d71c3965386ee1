/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confines a worker process. What a plugin needs is read from its file, without running any of its code. */
#ifndef FACCIA_VOICE_SANDBOX_H
#define FACCIA_VOICE_SANDBOX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct plugin_needs {
    uint32_t capabilities; /* FACCIA_VOICE_..., including what an old version could not declare */
    char *reads;           /* FACCIA_VOICE_READS: NUL-terminated paths */
    size_t reads_size;     /* bytes of all paths */
};

/* Returns false, with no needs, unless the file is a shared object with a constant table. */
bool plugin_needs_read(struct plugin_needs *needs, const char *path);
void plugin_needs_free(struct plugin_needs *needs);

/* Restrictions that a worker process puts on itself before its plugin is loaded, on Linux, in four layers:
 * - namespaces: no administrator's rights, no shared memory of other processes; without
 *   FACCIA_VOICE_NETWORK an empty network of its own;
 * - memory: processes of the same user cannot read or write its memory, nor it theirs;
 * - files (Landlock): which ones it may read and write; no signals to processes outside;
 * - system calls (seccomp).
 * Threads and programs that it starts are restricted too. Rights once lost do not come back, not even through
 * a set-user-ID program (no_new_privs). */

struct sandbox_path {
    const char *path;
    bool write;
};

struct sandbox {
    const char *plugin; /* its file; the plugin may read the folder */
    const struct plugin_needs *needs;
    const struct sandbox_path *paths; /* allowed by the operator */
    size_t path_count;
    pid_t daemon;
};

/* Layers that could not be set up, as sentences; empty if all were. */
struct sandbox_gaps {
    char spaces[160], files[160], calls[160];
};

/* Call while the process has one thread. */
void sandbox_enter(const struct sandbox *sandbox, struct sandbox_gaps *gaps);

/* Limits the address space of this process and its children and disables core dumps. With the address or
 * thread sanitizer, which map terabytes, it only disables core dumps. */

void memory_limit(uint32_t megabytes);

#endif
