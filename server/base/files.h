/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens files below a folder and never outside it, whatever symbolic links exist. The kernel resolves each
 * path in one step (openat2, RESOLVE_BENEATH), so concurrent changes of links are harmless. Without
 * openat2 (before Linux 5.6, or forbidden), no links are followed. */
#ifndef FACCIA_BASE_FILES_H
#define FACCIA_BASE_FILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Opens `path` relative to the open folder. Returns -1 with errno, which is EXDEV or ELOOP if the path
 * leads outside. flags: as for open(2), without O_CREAT. Adds O_CLOEXEC, and O_NONBLOCK so that a named
 * pipe does not block. */
int open_below_at(int folder, const char *path, int flags);

/* Likewise for a folder by name, which may itself be a link. */
int open_below(const char *folder, const char *path, int flags);

/* Opens a path that realpath(3) resolved. Returns -1 with errno, ELOOP or ENOTDIR if a part of it has become
 * a link since. flags as above. */
int open_without_links(const char *path, int flags);

/* Opens a regular file for reading. Returns NULL with errno. */
FILE *open_file_below(const char *folder, const char *path);

/* True if the path leads outside; opens it to find out. */
bool path_leads_outside(const char *folder, const char *path);

/* True if this errno means that the path leads outside. */
bool error_is_outside(int error);

/* Writes everything to a blocking descriptor, resuming after signals. False: see errno. */
bool write_all(int fd, const void *data, size_t size);

#endif
