/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens files below a folder, and nothing outside it, wherever symbolic links lead. The kernel resolves each
 * path in one step (openat2, RESOLVE_BENEATH), so that a link set meanwhile changes nothing; where it cannot
 * (before Linux 5.6, or forbidden), no link is followed at all. */
#ifndef FACCIA_BASE_BENEATH_H
#define FACCIA_BASE_BENEATH_H

#include <stdbool.h>
#include <stdio.h>

/* The descriptor of `path`, relative to the open folder, or -1 with errno: EXDEV or ELOOP when it leads
 * outside. flags as of open(2), without O_CREAT; O_CLOEXEC and O_NONBLOCK are added, so that a named pipe
 * does not block. */
int open_below_at(int folder, const char *path, int flags);

/* The same of a folder by its name, which may itself be a link. */
int open_below(const char *folder, const char *path, int flags);

/* Opens a regular file for reading. NULL with errno. */
FILE *open_file_below(const char *folder, const char *path);

/* Does the path lead outside? It is opened to see. */
bool path_leads_outside(const char *folder, const char *path);

/* Does errno say that the path leads outside? */
bool error_is_outside(int error);

#endif
