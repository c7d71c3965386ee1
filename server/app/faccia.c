/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia: the talking head on the command line, without a daemon. */
#include "server/app/cli.h"
#include <signal.h>
#include <stdio.h>
#include <string.h>

static const char usage[] = "Usage: faccia COMMAND [ARGUMENT]...\n"
                            "\n"
                            "  say      speak a text: its sound, its face animation, its timing\n"
                            "  timed    the face for recorded speech, from a timed transcription\n"
                            "  voices   list the voices\n"
                            "  models   list the head models\n"
                            "  eval     measure how well the lips can be read, engine by engine\n"
                            "  stimuli  make a listening test: speech in noise, with and without a face\n"
                            "  anova    analyse the results of such a test\n"
                            "  fit      make a speech pack from recordings of a speaker\n"
                            "\n"
                            "'faccia COMMAND --help' tells more. The daemon is facciad. The environment variable\n"
                            "FACCIA_VOICE_CONFIG may name a file with what the voice plugins are told.\n";

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
} commands[] = {
    {"say", say_main},   {"timed", timed_main},     {"voices", voices_main}, {"models", models_main},
    {"eval", eval_main}, {"stimuli", stimuli_main}, {"anova", anova_main},   {"fit", fit_main},
};

int main(int argc, char **argv) {
    signal(SIGPIPE, SIG_IGN); /* a closed pipe is an error like any other */
    const char *name = argc > 1 ? argv[1] : "";
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i].name, name))
            return commands[i].run(argc - 1, argv + 1);
    if (!strcmp(name, "--help") || !strcmp(name, "-h") || !strcmp(name, "help")) {
        fputs(usage, stdout);
        return EXIT_DONE;
    }
    if (!strcmp(name, "--version")) {
        puts("faccia " FACCIA_VERSION);
        return EXIT_DONE;
    }
    if (*name)
        cli_complain("no command '%s'", name);
    fputs(usage, stderr);
    return EXIT_USAGE;
}
