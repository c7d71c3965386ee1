/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the commands of the command line share. Exit codes: 0 done, 1 it could not be done, 2 it was asked
 * wrongly. */
#ifndef FACCIA_APP_CLI_H
#define FACCIA_APP_CLI_H

#include "server/base/buf.h"
#include "server/base/paths.h"
#include "server/synthesis/synthesis.h"
#include <stdio.h>

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* The stages, without the network. */
struct cli {
    uv_loop_t loop;
    struct paths paths;
    struct speech_packs packs;
    struct expressions *expressions;
    struct normalizers normalizers;
    struct pipeline pipeline;
};

/* Loads the packs, starts the voices and waits until they are there. -1 after a message. */
int cli_open(struct cli *cli);
void cli_close(struct cli *cli);

/* "faccia: ..." on standard error. */
void cli_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Reads the file, or standard input when it is "-". -1 after a message. */
int cli_read(const char *path, struct buf *text);

/* The text that a command is to work on: its words from optind on, joined by spaces, or the file path (NULL =
 * none), or standard input when the only word is "-". The exit code after a message, or -1 to go on. */
int cli_text(int argc, char **argv, const char *path, struct buf *text);

/* Whether the request could be spoken with that engine. -1 with *e; its field (PLACE_FIELD) is "engine" when
 * that is what does not fit. */
int cli_try_engine(const struct cli *cli, const struct speech_request *request, const char *engine,
                   struct error *e);

int say_main(int argc, char **argv);
int play_main(int argc, char **argv);
int voices_main(int argc, char **argv);
int models_main(int argc, char **argv);
int eval_main(int argc, char **argv);
int stimuli_main(int argc, char **argv);
int anova_main(int argc, char **argv);
int fit_main(int argc, char **argv);
int token_main(int argc, char **argv);
int timed_main(int argc, char **argv);
int align_main(int argc, char **argv);
int fap_main(int argc, char **argv);
int life_main(int argc, char **argv);
int check_main(int argc, char **argv);
int expressions_main(int argc, char **argv);

#endif
