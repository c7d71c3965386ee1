/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia: the talking head on the command line, without a daemon. */
#include "server/base/program.h"
#include "server/base/suggest.h"
#include "server/cli/cli.h"
#include <getopt.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    int (*run)(int argc, char **argv, const struct settings *settings);
    const char *help;
} commands[] = {
    {"say", say_main, "speak a text: sound, face animation, timing"},
    {"timed", timed_main, "animate the face for recorded speech, from a timed transcription"},
    {"play", play_main, "convert a recorded face and its sound"},
    {"film", film_main, "film the head as it speaks: MP4, WebM, GIF, pictures"},
#ifdef HAVE_BRIDGES
    {"camera", camera_main, "show the face of a room in a virtual camera"},
#endif
    {"fap", fap_main, "inspect, convert, encode and plot face animation files"},
    {"voices", voices_main, "list the voices"},
    {"models", models_main, "list the head models"},
    {"head", head_main, "export a head as an avatar for other programs (GLB, VRM); import heads"},
    {"expressions", expressions_main, "list the expressions, or write them as FAPs"},
#ifdef HAVE_RESEARCH
    {"eval", eval_main, "measure how well each engine's lips can be read"},
    {"stimuli", stimuli_main, "create a listening test: speech in noise, with and without a face"},
    {"anova", anova_main, "analyse the results of such a test"},
    {"fit", fit_main, "create a speech pack from recordings of a speaker"},
    {"corpus", corpus_main, "choose sentences that cover a language's sounds, to be recorded"},
    {"visemes", visemes_main, "group the phones of a recorded speaker by the look of the lips"},
    {"session", session_main, "record a speaker: the page that prompts, and the cutting of its takes"},
    {"speaker", speaker_main, "create a speech pack from a film of a speaker"},
#endif
#ifdef HAVE_LIBRARY
    {"align", align_main, "align a recording with its text: times and face"},
#endif
#ifdef HAVE_LIVE
    {"hear", hear_main, "animate the face for speech without a transcript, as it arrives"},
    {"coach", coach_main, "compare a learner's recording with a voice, sound by sound"},
#endif
#ifdef HAVE_RESEARCH
    {"life", life_main, "measure the face's idle motion"},
#endif
#ifdef HAVE_LIBRARY
    {"library", library_main, "read a folder of works, and list its contents and problems"},
#endif
    {"read", read_main, "show how a text is read aloud, word by word"},
    {"lexicon", lexicon_main, "check a pronunciation lexicon"},
    {"check", check_main, "check a text with markup for errors and for what is ignored"},
    {"token", token_main, "sign a token for a daemon that requires them"},
};

static void print_usage(FILE *out) {
    struct buf text = {0};
    fputs("Usage: faccia [SETTING]... COMMAND [OPTION]...\nThe talking head without a network.\n\n", out);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        fprintf(out, "  %-12s %s\n", commands[i].name, commands[i].help);
    fputs("\nSee 'faccia COMMAND --help'. These settings are shared with the daemon, facciad:\n\n", out);
    settings_help(PROGRAM_COMMANDS, &text);
    fwrite(text.data, 1, text.size, out);
    buf_free(&text);
}

static int run(int argc, char **argv, const struct settings *settings) {
    const char *name = argc ? argv[0] : "";
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (!strcmp(commands[i].name, name)) {
            optind = 0; /* the command parses its own options */
            return commands[i].run(argc, argv, settings);
        }
    if (!strcmp(name, "help")) {
        print_usage(stdout);
        return EXIT_DONE;
    }
    if (!*name) {
        cli_complain("a command is needed: 'faccia --help' lists the commands");
        return EXIT_USAGE;
    }
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        suggest_name(&near, commands[i].name, commands[i].name);
    cli_complain("unknown command '%s'%s; 'faccia --help' lists the commands", name,
                 suggestions_text(&near, text));
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
