/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the commands of the command line share. Exit codes: 0 done, 1 it could not be done, 2 it was asked
 * wrongly. */
#ifndef FACCIA_APP_CLI_H
#define FACCIA_APP_CLI_H

#include "server/app/stages.h"
#include "server/base/buf.h"
#include <stdio.h>

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* The stages, without the network. */
struct cli {
    uv_loop_t loop;
    struct stages stages;
};

/* Loads all, starts the voices and waits until they are there. -1 after a message; cli_close all the same. */
int cli_open(struct cli *cli, const struct settings *settings);
void cli_close(struct cli *cli);

/* Loads what is wanted, for commands that speak nothing (loop NULL) or only play. As stages_load, after a
 * message. */
int cli_load(struct stages *stages, const struct settings *settings, unsigned wanted, uv_loop_t *loop);

/* The error with its code, as "faccia: FIELD: message (code)". */
void cli_complain_of(const struct error *e);

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

/* The commands. argv[0] is the name. */
int say_main(int argc, char **argv, const struct settings *settings);
int play_main(int argc, char **argv, const struct settings *settings);
int voices_main(int argc, char **argv, const struct settings *settings);
int head_main(int argc, char **argv, const struct settings *settings);
int models_main(int argc, char **argv, const struct settings *settings);
int eval_main(int argc, char **argv, const struct settings *settings);
int stimuli_main(int argc, char **argv, const struct settings *settings);
int anova_main(int argc, char **argv, const struct settings *settings);
int fit_main(int argc, char **argv, const struct settings *settings);
int token_main(int argc, char **argv, const struct settings *settings);
int timed_main(int argc, char **argv, const struct settings *settings);
int align_main(int argc, char **argv, const struct settings *settings);
int hear_main(int argc, char **argv, const struct settings *settings);
int fap_main(int argc, char **argv, const struct settings *settings);
int life_main(int argc, char **argv, const struct settings *settings);
int read_main(int argc, char **argv, const struct settings *settings);
int check_main(int argc, char **argv, const struct settings *settings);
int library_main(int argc, char **argv, const struct settings *settings);
int expressions_main(int argc, char **argv, const struct settings *settings);

#endif
