/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cli.h"
int stimuli_main(int argc, char **argv) { (void)argc; (void)argv; return EXIT_FAILED; }
