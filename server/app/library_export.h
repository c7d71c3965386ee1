/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia library export: a work with its sound, as files for others. */
#ifndef FACCIA_APP_LIBRARY_EXPORT_H
#define FACCIA_APP_LIBRARY_EXPORT_H

#include "server/app/cli.h"

/* argv[0] is "export". The exit code. */
int library_export_main(int argc, char **argv, const struct settings *settings);

#endif
