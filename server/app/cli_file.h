/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file that a command writes: it takes its name when it is whole. Until then, and when something fails,
 * what was there before under that name stays, and nothing else is seen. Devices and pipes are written to as
 * they are. */
#ifndef FACCIA_APP_CLI_FILE_H
#define FACCIA_APP_CLI_FILE_H

#include <stdbool.h>
#include <stdio.h>

/* Zeroed: not open. */
struct cli_file {
    FILE *file;
    const char *path; /* as it was asked for; borrowed */
    char *place;      /* where it goes: its links followed; NULL: what is written to is no regular file */
    char *part;       /* its name until then; NULL: it has none */
};

/* "-" is standard output. -1 after a message. */
int cli_create(struct cli_file *file, const char *path);

/* Closes it; what is not well is thrown away. 0 when all of it could be written, or it was not open. -1 after
 * a message; or without one when it is not well. */
int cli_finish(struct cli_file *file, bool well);

#endif
