/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/options.h"
#include "server/base/suggest.h"
#include "server/base/utf8.h"
#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static void complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

static void complain(const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    utf8_mend(text); /* it quotes arguments */
    fprintf(stderr, "%s: %s\n", program_invocation_short_name, text);
}

/* Is the argument an option, complete or with a value after "="? */
static bool is_option(const char *argument, const char *letters, const struct option *options) {
    if (argument[0] != '-' || !argument[1])
        return false;
    if (argument[1] != '-')
        return strchr("+:", argument[1]) == NULL && strchr(letters, argument[1]) && !argument[2];
    const char *name = argument + 2;
    size_t length = strcspn(name, "=");
    for (; options->name; options++)
        if (strlen(options->name) == length && !memcmp(options->name, name, length))
            return true;
    return false;
}

/* `argument` is where getopt_long stopped; optopt, which letter or option it refuses. */
static void complain_of_unknown(const char *argument, const struct option *options) {
    char name[64], near[256] = "";
    size_t used = 0, matches = 0;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(argument, "="), argument);
    if (strncmp(name, "--", 2) != 0) {
        complain("unknown option '-%c'", optopt);
        return;
    }
    struct suggestions suggestions = suggestions_for(name + 2);
    for (const struct option *option = options; option->name; option++) {
        if (!strcmp(option->name, name + 2)) {
            complain("%s takes no value", name);
            return;
        }
        matches += !strncmp(option->name, name + 2, strlen(name + 2));
        suggest_name(&suggestions, option->name, option->name);
    }
    for (size_t i = 0; i < suggestions.count && used < sizeof near; i++)
        used += (size_t)snprintf(near + used, sizeof near - used, "%s--%s",
                                 i ? ", " : "; near: ", suggestions.names[i]);
    complain(matches > 1 ? "'%s' begins several options%s" : "unknown option '%s'%s", name, near);
}

int options_next(int argc, char **argv, const char *letters, const struct option *options, int *at) {
    char quiet[128];
    const bool loud = opterr, in_order = *letters == '+';
    snprintf(quiet, sizeof quiet, "%s:%s", in_order ? "+" : "", letters + in_order);
    opterr = 0;
    int c = getopt_long(argc, argv, quiet, options, at);
    opterr = loud;
    if (c == -1)
        return -1;
    const char *argument = argv[optind - 1];
    if (c == ':' && loud)
        complain("%s needs a value", argument);
    else if (c == '?' && loud)
        complain_of_unknown(argument, options);
    if (c == ':' || c == '?')
        return '?';
    if (optarg != argument || !is_option(optarg, letters, options))
        return c;
    if (loud)
        complain("%s needs a value, but the option '%s' follows", argv[optind - 2], optarg);
    return '?';
}
