/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cli_options.h"
#include "server/app/cli.h"
#include <getopt.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

enum { MOST = 32, FIRST = 256 };

static int take_number(const struct cli_option *option, const char *text) {
    bool whole = option->kind == CLI_WHOLE;
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= option->min && value <= option->max) ||
        (whole && value != floor(value))) {
        cli_complain("--%s: must be a %snumber from %g to %g", option->name, whole ? "whole " : "",
                     option->min, option->max);
        return EXIT_USAGE;
    }
    if (whole)
        *(int *)option->out = (int)value;
    else
        *(double *)option->out = value;
    return -1;
}

static int take(const struct cli_option *option, const char *text, void *ctx) {
    switch (option->kind) {
    case CLI_FLAG:
        *(bool *)option->out = true;
        return -1;
    case CLI_TEXT:
        *(const char **)option->out = text;
        return -1;
    case CLI_WHOLE:
    case CLI_NUMBER:
        return take_number(option, text);
    case CLI_CALL:
        break;
    }
    return option->take(ctx, option->name, text);
}

int cli_options(int argc, char **argv, const char *usage, const struct cli_option *list, void *ctx) {
    struct option options[MOST + 2] = {{"help", no_argument, NULL, 'h'}};
    char letters[2 * MOST + 2] = "h";
    size_t count = 0, used = 1;
    for (; count < MOST && list[count].name; count++) {
        bool flag = list[count].kind == CLI_FLAG;
        options[count + 1] = (struct option){list[count].name, flag ? no_argument : required_argument, NULL,
                                             FIRST + (int)count};
        if (!list[count].letter)
            continue;
        letters[used++] = list[count].letter;
        if (!flag)
            letters[used++] = ':';
    }
    for (int c; (c = getopt_long(argc, argv, letters, options, NULL)) != -1;) {
        size_t i = c >= FIRST ? (size_t)(c - FIRST) : 0;
        while (c < FIRST && i < count && list[i].letter != c)
            i++;
        if (c == 'h' || c == '?' || i == count) {
            if (c == 'h')
                fputs(usage, stdout);
            else
                fprintf(stderr, "Try 'faccia %s --help'.\n", argv[0]);
            return c == 'h' ? EXIT_DONE : EXIT_USAGE;
        }
        int status = take(&list[i], optarg, ctx);
        if (status >= 0)
            return status;
    }
    return -1;
}
