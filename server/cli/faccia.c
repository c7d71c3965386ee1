/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia: the talking head on the command line, without a daemon. */
#include "server/base/program.h"
#include "server/cli/cli.h"
#include <getopt.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    int (*run)(int argc, char **argv, const struct settings *settings);
    const char *help;
} commands[] = {
    {"say", say_main, "speak a text: its sound, its face animation, its timing"},
    {"timed", timed_main, "the face for recorded speech, from a timed transcription"},
    {"play", play_main, "a recorded face and its sound in other forms"},
    {"fap", fap_main, "look into, convert, code and draw files of face animation"},
    {"voices", voices_main, "list the voices"},
    {"models", models_main, "list the head models"},
    {"head", head_main, "a head as an avatar for other programs (GLB, VRM); heads of other origin"},
    {"expressions", expressions_main, "list the expressions, or write how they look"},
#ifdef HAVE_RESEARCH
    {"eval", eval_main, "measure how well the lips can be read, engine by engine"},
    {"stimuli", stimuli_main, "make a listening test: speech in noise, with and without a face"},
    {"anova", anova_main, "analyse the results of such a test"},
    {"fit", fit_main, "make a speech pack from recordings of a speaker"},
#endif
#ifdef HAVE_LIBRARY
    {"align", align_main, "times and face of a recording with its text"},
#endif
#ifdef HAVE_LIVE
    {"hear", hear_main, "the face of a voice whose words nobody knows, while it speaks"},
#endif
#ifdef HAVE_RESEARCH
    {"life", life_main, "what the face does of itself, in figures"},
#endif
#ifdef HAVE_LIBRARY
    {"library", library_main, "read a folder of works and tell what is in it, and what is wrong"},
#endif
    {"read", read_main, "tell how a text is read aloud, word by word"},
    {"lexicon", lexicon_main, "check a file of pronunciations"},
    {"check", check_main, "tell what in a text with markup would not be acted on"},
    {"token", token_main, "sign a token for a daemon that demands them"},
};

static void print_usage(FILE *out) {
    struct buf text = {0};
    fputs("Usage: faccia [SETTING]... COMMAND [OPTION]...\nThe talking head without a network.\n\n", out);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        fprintf(out, "  %-12s %s\n", commands[i].name, commands[i].help);
    fputs("\n'faccia COMMAND --help' tells more. The daemon is facciad, whose settings these are, too:\n\n",
          out);
    settings_help(PROGRAM_COMMANDS, &text);
    fwrite(text.data, 1, text.size, out);
    buf_free(&text);
}

static int run(int argc, char **argv, const struct settings *settings) {
    const char *name = argc ? argv[0] : "";
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i].name, name)) {
            optind = 0; /* the command has options of its own */
            return commands[i].run(argc, argv, settings);
        }
    if (!strcmp(name, "help")) {
        print_usage(stdout);
        return EXIT_DONE;
    }
    cli_complain(*name ? "no command '%s'; 'faccia --help' lists them"
                       : "a command is needed: 'faccia --help' lists them",
                 name);
    return EXIT_USAGE;
}

int main(int argc, char **argv) {
    struct paths paths;
    struct settings settings;
    struct settings_request request;
    struct error e;
    int status = EXIT_DONE;
    program_begin();
    paths_find(&paths);
    if (settings_read(&settings, &request, PROGRAM_COMMANDS, argc, argv, &paths, &e)) {
        cli_complain_of(&e);
        status = EXIT_USAGE;
    } else if (request.help) {
        print_usage(stdout);
    } else if (request.version) {
        puts("faccia " FACCIA_VERSION);
    } else {
        log_open(settings_log_format(&settings));
        status = run(argc - request.rest, argv + request.rest, &settings);
    }
    settings_free(&settings);
    paths_free(&paths);
    return status;
}
