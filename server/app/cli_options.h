/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The options of a command as a table. */
#ifndef FACCIA_APP_CLI_OPTIONS_H
#define FACCIA_APP_CLI_OPTIONS_H

enum cli_option_kind { CLI_FLAG, CLI_TEXT, CLI_WHOLE, CLI_NUMBER, CLI_CALL };

struct cli_option {
    const char *name;
    char letter; /* 0 = none */
    enum cli_option_kind kind;
    void *out;       /* FLAG: bool; TEXT: const char *; WHOLE: int; NUMBER: double */
    double min, max; /* WHOLE, NUMBER */
    /* CALL: what follows the option; it may come again. The exit code, after a message, or -1 to go on. */
    int (*take)(void *ctx, const char *name, const char *text);
};

/* The list ends with a NULL name; --help, -h need not be in it. argv[0] is the command's name. The exit code,
 * after a message or the usage, or -1 to go on: what is left then is argv from optind on. */
int cli_options(int argc, char **argv, const char *usage, const struct cli_option *list, void *ctx);

#endif
