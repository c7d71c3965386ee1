/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia align: when a recording says what, and the face that goes with it. */
#include "protocol/say_options.h"
#include "server/app/align_write.h"
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia align [OPTION]... SOUND [--text FILE] [--timing FILE]\n"
    "Finds when the recording SOUND (WAV, FLAC, Ogg, MP3) says each word and phone of its transcript, by "
    "itself or\n"
    "from a file of times, and writes timing, face and sound. Without --json, --fap or --wav the timing goes "
    "to\n"
    "standard output.\n"
    "\n"
    "  -t, --text FILE      what is said, plain text, UTF-8\n"
    "      --timing FILE    times of the phones: Festival or HTK .lab, .mlf, Praat TextGrid, faccia's JSON, "
    "byte "
    "offsets\n"
    "      --names FILE     JSON object: the timing's names of phones in IPA\n"
    "      --tier NAME      of a TextGrid: has the phones; found by its name when it is not told\n"
    "      --word-tier NAME has the words\n"
    "  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)\n"
    "      --gender WORD    of the speaker: female or male; found out when it is not told\n" SPEAK_HELP_FPS
        SPEAK_HELP_ENGINE SPEAK_HELP_CONTACTS SPEAK_HELP_STILL /* made of protocol/messages.json */
    "      --seed N         another life of the face (0)\n"
    "      --json FILE      phones and words with their times\n"
    "      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)\n"
    "      --wav FILE       the sound, mono 16 bit\n"
    "  -q, --quiet          no progress\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard input or output. Exit status: 0 done, 1 failed, 2 wrong usage.\n";

static int work(struct align *a) {
    struct error e;
    char text[400];
    int found = 1;
    while (found > 0 && (found = aligned_recording_advance(a->reading, &e)) > 0) {
        align_tell(a);
        if (align_write(a, a->reading->until))
            return -1;
    }
    if (found < 0) {
        cli_complain("%s%s%s", a->text ? a->text : "", a->text ? ":" : "", error_text(&e, text, sizeof text));
        return -1;
    }
    if (a->reading->rest > 3)
        cli_complain("warning: the recording goes on for %.0f s after its text", a->reading->rest);
    return align_write(a, INFINITY) ? -1 : align_end_outputs(a);
}

/* Reads --timing, with --names. -1 after a message. */
static int read_timing(struct align *a, struct times *times) {
    struct buf data = {0};
    json_error_t why;
    json_t *names = a->names ? json_load_file(a->names, 0, &why) : NULL;
    const struct times_options options = {
        .format = TIMES_GUESS, .tier = a->tier, .word_tier = a->word_tier, .names = names, .pack = a->pack};
    struct error e;
    char text[400];
    int result = -1;
    if (a->names && !json_is_object(names))
        cli_complain("%s:%d:%d: %s", a->names, names ? 1 : why.line, names ? 1 : why.column,
                     names ? "wanted is an object" : why.text);
    else if (!cli_read(a->timing, &data)) {
        result = times_read(times, &options, data.data ? (char *)data.data : "", data.size, &e);
        if (result)
            cli_complain("%s:%s", a->timing, error_text(&e, text, sizeof text));
        else if (*times->unnamed)
            cli_complain("warning: the table has no IPA for the phone \"%s\"", times->unnamed);
    }
    json_decref(names);
    buf_free(&data);
    return result;
}

static int run(struct align *a, const struct settings *settings) {
    struct reference_slot reference = {.reference = NULL};
    struct buf script = {0};
    struct times times = {0};
    struct error e;
    char text[400];
    int result = -1;
    snprintf(reference.worker, sizeof reference.worker, "%s", settings->voices.worker);
    reference.unconfined = settings->voices.unconfined;
    snprintf(reference.path, sizeof reference.path, "%s/espeak.so", settings->voices.plugin_dir);
    if ((!a->text || !cli_read(a->text, &script)) && (!a->timing || !read_timing(a, &times))) {
        size_t skip = script.size >= 3 && !memcmp(script.data, "\xEF\xBB\xBF", 3) ? 3 : 0;
        const struct aligned_recording_options options = {
            .sound = a->sound,
            .text = a->text && script.size ? (char *)script.data + skip : NULL,
            .text_size = script.size - skip,
            .lang = a->request.lang,
            .gender = a->gender,
            .times = a->timing ? &times : NULL,
            .reference = &reference};
        a->reading = aligned_recording_open(&options, &e);
        if (!a->reading)
            cli_complain("%s", error_text(&e, text, sizeof text));
        else if (!a->reading->tokens.count && !a->timing)
            cli_complain("%s: there are no words in it", a->text);
        else
            result = align_open_outputs(a) ? -1 : work(a);
    }
    if (a->progress)
        fputs("\r\033[K", stderr);
    for (int i = 0; i < OUTPUTS; i++) {
        if (align_close_output(&a->outputs[i], i == WAV, !result))
            result = -1;
        export_free(&a->outputs[i].export);
    }
    aligned_recording_free(a->reading);
    reference_close(reference.reference);
    times_free(&times);
    buf_free(&script);
    return result ? EXIT_FAILED : EXIT_DONE;
}

/* The exit code, or -1 to go on. */
static int parse(int argc, char **argv, struct align *a) {
    static const struct option options[] = {
        {"text", 1, NULL, 't'},      {"timing", 1, NULL, 'T'}, {"names", 1, NULL, 'N'},
        {"lang", 1, NULL, 'l'},      {"gender", 1, NULL, 'g'}, {"fps", 1, NULL, 1},
        {"engine", 1, NULL, 'e'},    {"contacts", 1, NULL, 1}, {"still", 0, NULL, 1},
        {"seed", 1, NULL, 1},        {"json", 1, NULL, 'J'},   {"fap", 1, NULL, 'F'},
        {"wav", 1, NULL, 'W'},       {"quiet", 0, NULL, 'q'},  {"tier", 1, NULL, 'P'},
        {"word-tier", 1, NULL, 'O'}, {"help", 0, NULL, 'h'},   {0},
    };
    struct error e;
    char message[400];
    for (int c, at; (at = -1, c = getopt_long(argc, argv, "t:l:e:qh", options, &at)) != -1;) {
        const char **const texts[] = {['t'] = &a->text,
                                      ['T'] = &a->timing,
                                      ['N'] = &a->names,
                                      ['P'] = &a->tier,
                                      ['O'] = &a->word_tier,
                                      ['g'] = &a->gender,
                                      ['J'] = &a->outputs[JSON].path,
                                      ['F'] = &a->outputs[FAP].path,
                                      ['W'] = &a->outputs[WAV].path};
        const char *name = c == 'l' ? "lang" : c == 'e' ? "engine" : at >= 0 ? options[at].name : "";
        const char *word = optarg ? optarg : "true";
        struct request_value value = {REQUEST_WORD, word, strlen(word), 0};
        if (c == 'h') {
            fputs(usage, stdout);
            return EXIT_DONE;
        }
        if (c == '?') {
            fputs("Try 'faccia align --help'.\n", stderr);
            return EXIT_USAGE;
        }
        if (c == 'q') {
            a->progress = false;
        } else if ((size_t)c < sizeof texts / sizeof *texts && texts[c]) {
            *texts[c] = optarg;
        } else if (request_set(&a->request, name, value, &e)) {
            cli_complain("--%s", error_text(&e, message, sizeof message));
            return EXIT_USAGE;
        }
    }
    if (a->gender && strcmp(a->gender, "female") != 0 && strcmp(a->gender, "male") != 0) {
        cli_complain("--gender: wanted is female or male");
        return EXIT_USAGE;
    }
    if (optind + 1 != argc || (!a->text && !a->timing)) {
        cli_complain(optind + 1 != argc ? "one sound is needed" : "a --text or a --timing is needed");
        return EXIT_USAGE;
    }
    a->sound = argv[optind];
    return -1;
}

/* The language and the engine. The exit code, or -1 to go on. */
static int choose(struct align *a) {
    if (!a->request.lang)
        a->request.lang = mem_strdup("it");
    a->pack = speech_packs_find(a->packs, a->request.lang);
    char text[SUGGESTIONS_TEXT];
    if (!a->pack) {
        struct suggestions near = suggestions_for(a->request.lang);
        for (size_t i = 0; i < a->packs->count; i++)
            suggest_name(&near, speech_pack_lang(a->packs->packs[i]), speech_pack_lang(a->packs->packs[i]));
        cli_complain("lang: no language '%s'%s", a->request.lang, suggestions_text(&near, text));
        return EXIT_USAGE;
    }
    if (!face_engine_speaks(a->request.engine, a->pack)) {
        struct suggestions near = suggestions_for(a->request.engine);
        suggest_names(&near, face_engines());
        cli_complain("engine: no engine '%s' for '%s'%s", a->request.engine, a->request.lang,
                     suggestions_text(&near, text));
        return EXIT_USAGE;
    }
    return -1;
}

int align_main(int argc, char **argv, const struct settings *settings) {
    struct align a = {.progress = isatty(STDERR_FILENO)};
    struct stages stages;
    request_init(&a.request);
    int status = parse(argc, argv, &a);
    if (status < 0) {
        if (!a.outputs[WAV].path && !a.outputs[FAP].path && !a.outputs[JSON].path)
            a.outputs[JSON].path = "-";
        if (cli_load(&stages, settings, STAGES_SPEECH, NULL)) {
            status = EXIT_FAILED;
        } else {
            a.packs = &stages.packs;
            status = choose(&a);
            status = status < 0 ? run(&a, settings) : status;
        }
        stages_free(&stages);
    }
    request_free(&a.request);
    return status;
}
