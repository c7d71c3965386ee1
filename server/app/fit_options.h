/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What faccia fit is asked for. */
#ifndef FACCIA_APP_FIT_OPTIONS_H
#define FACCIA_APP_FIT_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

enum { FIT_TESTS = 64 };

struct fit_choices {
    const char *base, *tag, *name, *output; /* NULL = not said */
    int first, then;
    double strength; /* 0 = to be found */
    bool compare, rest, own;
    const char *tests[FIT_TESTS];
    size_t test_count;
};

/* The exit code, after a message, or -1 to go on: the recordings then are argv from optind on. */
int fit_options_parse(int argc, char **argv, struct fit_choices *f);

#endif
