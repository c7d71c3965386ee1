/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia: the talking head on the command line, without a daemon. */
#include "server/app/cli.h"
#include <signal.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *help;
} commands[] = {
    {"say", say_main, "speak a text: its sound, its face animation, its timing"},
    {"timed", timed_main, "the face for recorded speech, from a timed transcription"},
    {"play", play_main, "a recorded face and its sound in other forms"},
    {"fap", fap_main, "look into, convert, code and draw files of face animation"},
    {"voices", voices_main, "list the voices"},
    {"models", models_main, "list the head models"},
    {"expressions", expressions_main, "list the expressions, or write how they look"},
    {"eval", eval_main, "measure how well the lips can be read, engine by engine"},
    {"stimuli", stimuli_main, "make a listening test: speech in noise, with and without a face"},
    {"anova", anova_main, "analyse the results of such a test"},
    {"fit", fit_main, "make a speech pack from recordings of a speaker"},
    {"align", align_main, "times and face of a recording with its text"},
    {"life", life_main, "what the face does of itself, in figures"},
    {"check", check_main, "tell what in a text with markup would not be acted on"},
    {"token", token_main, "sign a token for a daemon that demands them"},
};

static void print_usage(FILE *out) {
    fputs("Usage: faccia COMMAND [OPTION]...\nThe talking head without a network.\n\n", out);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        fprintf(out, "  %-12s %s\n", commands[i].name, commands[i].help);
    fputs("\n'faccia COMMAND --help' tells more. The daemon is facciad. $FACCIA_VOICE_CONFIG may name a file "
          "with what\n"
          "the voice plugins are told.\n",
          out);
}

int main(int argc, char **argv) {
    signal(SIGPIPE, SIG_IGN); /* a closed pipe is an error like any other */
    const char *name = argc > 1 ? argv[1] : "";
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i].name, name))
            return commands[i].run(argc - 1, argv + 1);
    if (!strcmp(name, "--help") || !strcmp(name, "-h") || !strcmp(name, "help")) {
        print_usage(stdout);
        return EXIT_DONE;
    }
    if (!strcmp(name, "--version")) {
        puts("faccia " FACCIA_VERSION);
        return EXIT_DONE;
    }
    if (*name)
        cli_complain("no command '%s'", name);
    print_usage(stderr);
    return EXIT_USAGE;
}
