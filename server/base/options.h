/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of the command line: getopt_long with messages that name the program and suggest names. */
#ifndef FACCIA_BASE_OPTIONS_H
#define FACCIA_BASE_OPTIONS_H

#include <getopt.h>

/* Reads the next option; arguments and result are those of getopt_long, and `at` may be NULL. Returns '?' for
 * an unknown option, a missing value, and an option in the place of a value ("--wav --fap"; "--wav=--fap" is
 * a value), after a message on standard error unless opterr is 0. */
int options_next(int argc, char **argv, const char *letters, const struct option *options, int *at);

#endif
