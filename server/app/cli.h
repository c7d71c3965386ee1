/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the commands of the command line share. Exit codes: 0 done, 1 it could not be done, 2 it was asked wrongly. */
#ifndef FACCIA_APP_CLI_H
#define FACCIA_APP_CLI_H

#include "server/base/paths.h"
#include "server/stream/speech.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* The stages, without the network. */
struct cli {
    uv_loop_t loop;
    struct paths paths;
    struct speech_packs packs;
    struct studio studio;
};

/* Loads the packs, starts the voices and waits until they are there. -1 after a message. */
int cli_open(struct cli *cli);
void cli_close(struct cli *cli);

/* "faccia: ..." on standard error. */
void cli_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

int say_main(int argc, char **argv);
int voices_main(int argc, char **argv);
int models_main(int argc, char **argv);
int timed_main(int argc, char **argv);

#endif
