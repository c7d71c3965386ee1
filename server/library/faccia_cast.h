/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cast of a file, for the commands of faccia. */
#ifndef FACCIA_LIBRARY_FACCIA_CAST_H
#define FACCIA_LIBRARY_FACCIA_CAST_H

#include "server/library/cast.h"

struct cli;
struct settings;

/* Reads a work, and chooses its cast from the voices of `cli` and the heads of the settings. -1 with *e: the
 * work or its WORK.cast.json cannot be read. Free the cast in either case. */
int cast_of_file(const char *folder, const char *path, const struct cli *cli, const struct settings *settings,
                 struct cast *cast, struct error *e);

/* faccia library cast. argv[0] is "cast". Returns an exit code. */
int library_cast_main(int argc, char **argv, const struct settings *settings);

#endif
