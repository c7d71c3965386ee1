/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the commands of faccia: output files, options, and the components without the network. */
#ifndef FACCIA_CLI_CLI_H
#define FACCIA_CLI_CLI_H

#include "server/base/buf.h"
#include "server/daemon/components.h"
#include <getopt.h>
#include <stdbool.h>
#include <stdio.h>

/* An output file. It appears under its name only when complete; until then, and after a failure, an
 * existing file stays untouched. Devices and pipes are written to directly. Zeroed: not open. */
struct cli_file {
    FILE *file;
    const char *path; /* as given by the user; borrowed */
    char *place;      /* destination with links resolved; NULL: not a regular file */
    char *part;       /* temporary name; NULL: none */
};

/* "-" is standard output. -1 after a message. */
int cli_create(struct cli_file *file, const char *path);

/* Closes the file, and discards it unless `well`. 0: all was written, or it was not open. -1 after a
 * message; without one if not `well`. */
int cli_finish(struct cli_file *file, bool well);

/* A command's options as a table. */

enum cli_option_kind { CLI_FLAG, CLI_TEXT, CLI_WHOLE, CLI_NUMBER, CLI_CALL };

struct cli_option {
    const char *name;
    char letter; /* 0 = none */
    enum cli_option_kind kind;
    void *out;       /* FLAG: bool; TEXT: const char *; WHOLE: int; NUMBER: double */
    double min, max; /* WHOLE, NUMBER */
    /* CALL: receives the argument; may be repeated. Returns an exit code after a message, or -1 to
     * continue. */
    int (*take)(void *ctx, const char *name, const char *text);
};

/* Number of arguments that may be options: all, or those before a text that begins with a minus ("-5 °C").
 * Pass it to options_next instead of argc. */
int cli_option_count(int argc, char **argv, const char *letters, const struct option *options);

/* The list ends with a NULL name; --help and -h are implied. argv[0] is the command's name. Returns an
 * exit code after a message or the usage, or -1 to continue with argv from optind on. */
int cli_options(int argc, char **argv, const char *usage, const struct cli_option *list, void *ctx);

/* The settings with the files of a command's --lexicon, which go before those of the settings. */
struct cli_lexicons {
    struct settings settings; /* a copy; borrows all but the list */
    char **files;
    size_t count, cap;
};
void cli_lexicons_add(struct cli_lexicons *lexicons, char *path);
const struct settings *cli_lexicons_with(struct cli_lexicons *lexicons, const struct settings *settings);
void cli_lexicons_free(struct cli_lexicons *lexicons);

/* Exit codes: 0 success, 1 failure, 2 wrong usage. */

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

struct cli {
    uv_loop_t loop;
    struct components components;
};

/* Loads everything, starts the voices and waits for them. -1 after a message; call cli_close in either
 * case. */
int cli_open(struct cli *cli, const struct settings *settings);
void cli_close(struct cli *cli);

/* Like components_load, but prints the error. For commands that do not speak (loop NULL) or only play. */
int cli_load(struct components *components, const struct settings *settings, unsigned wanted,
             uv_loop_t *loop);

/* Prints the error with its code: "faccia: FIELD: message (code)". */
void cli_complain_of(const struct error *e);

/* Prints an error or warning of a text, with its place in the file `path` if that is not NULL: "faccia:
 * a.xml:2:1: warning: ...". */
void cli_complain_at(const char *path, bool warning, const struct error *e);

/* Prints "faccia: ..." on standard error. */
void cli_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Reads a file, or standard input for "-". -1 after a message. */
int cli_read(const char *path, struct buf *text);

/* Reads a command's text: its words from optind on, joined by spaces; or the file `path` (NULL = none); or
 * standard input if the only word is "-". Returns an exit code after a message, or -1 to continue. */
int cli_text(int argc, char **argv, const char *path, struct buf *text);

/* Checks that the engine can speak the request. -1 with *e, whose field is "engine" if the engine does not
 * fit. */
int cli_try_engine(const struct cli *cli, const struct speech_request *request, const char *engine,
                   struct error *e);

/* Replaces this process by the Node.js program models/tools/TOOL.mjs with the given words. Returns an exit
 * code after a message, which names the command. */
int cli_run_tool(const struct settings *settings, const char *tool, const char *command, int count,
                 char **words);

/* Makes the face of "joy", "performative:greet=0.5": [KIND:]NAME[=INTENSITY], the kind "affect" if none is
 * named. -1 after a message, which begins with the option. */
struct expressions;
struct fap_frame;
int cli_pose(const struct expressions *all, const char *option, const char *wish, struct fap_frame *frame);

/* The commands. argv[0] is the command's name. */
int say_main(int argc, char **argv, const struct settings *settings);
int play_main(int argc, char **argv, const struct settings *settings);
int voices_main(int argc, char **argv, const struct settings *settings);
int head_main(int argc, char **argv, const struct settings *settings);
int models_main(int argc, char **argv, const struct settings *settings);
int eval_main(int argc, char **argv, const struct settings *settings);
int stimuli_main(int argc, char **argv, const struct settings *settings);
int anova_main(int argc, char **argv, const struct settings *settings);
int speaker_main(int argc, char **argv, const struct settings *settings);
int session_main(int argc, char **argv, const struct settings *settings);
int corpus_main(int argc, char **argv, const struct settings *settings);
int visemes_main(int argc, char **argv, const struct settings *settings);
int fit_main(int argc, char **argv, const struct settings *settings);
int token_main(int argc, char **argv, const struct settings *settings);
int timed_main(int argc, char **argv, const struct settings *settings);
int align_main(int argc, char **argv, const struct settings *settings);
int hear_main(int argc, char **argv, const struct settings *settings);
int coach_main(int argc, char **argv, const struct settings *settings);
int film_main(int argc, char **argv, const struct settings *settings);
int camera_main(int argc, char **argv, const struct settings *settings);
int fap_main(int argc, char **argv, const struct settings *settings);
int life_main(int argc, char **argv, const struct settings *settings);
int read_main(int argc, char **argv, const struct settings *settings);
int lexicon_main(int argc, char **argv, const struct settings *settings);
int check_main(int argc, char **argv, const struct settings *settings);
int library_main(int argc, char **argv, const struct settings *settings);
int expressions_main(int argc, char **argv, const struct settings *settings);

#endif
