/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia say: a text through all stages into files. */
#include "server/app/cli.h"
#include "server/app/cli_file.h"
#include "server/app/cli_written.h"
#include "server/app/osc_play.h"
#include "server/base/buf.h"
#include "server/export/export.h"
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia say [OPTION]... (TEXT | --file FILE | -)\n"
    "Speaks TEXT, a file, or standard input (-). Without FILE the timing is told.\n"
    "\n"
    "  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)\n"
    "  -v, --voice ID       a voice that 'faccia voices' lists\n"
    "      --gender WORD    female or male: of the voice, where none is named\n"
    "  -r, --rate WPM       words per minute, 40 to 500\n"
    "      --pitch FACTOR, --volume FACTOR  0.25 to 4 (1)\n"
    "      --fps N          FAP frames per second, 1 to 120 (25)\n"
    "  -e, --engine NAME    visible-speech engine: dominance, cohen-massaro, context, syllable or table\n"
    "      --markup KIND    auto, plain, apml, jsml, ssml, emotionml, bml, fml (auto)\n"
    "      --life FACTOR    strength of the signs of life, 0 to 2 (1)\n"
    "      --blend RULE     how expressions share the mouth with speech: auto, regions or weighted (auto)\n"
    "      --contacts HOW   lips that must touch do, whatever the engine makes: on, off, or engine:\n"
    "                       off for the baselines cohen-massaro and table, on for the others (engine)\n"
    "      --normalize WHICH  on, or off: numbers, signs and short forms are left to the voice (on)\n"
    "      --still          only the lips move\n"
    "      --seed N         another life of the face; the same number gives the same face (0)\n"
    "  -f, --file FILE      the text\n"
    "      --voice-file FILE  somebody's recorded voice in place of a text, as 'faccia hear FILE'\n"
    "      --open           speak standard input (-) while it is written\n"
    "      --audio DIR      sound files that the text may name (SSML's audio); default $FACCIA_AUDIO\n"
    "      --wav FILE       the sound, mono 16 bit\n"
    "      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)\n"
    "      --fapc FILE      the same at a few kilobits a second\n"
    "      --ogg FILE       the sound as Opus in Ogg\n"
    "      --ndjson FILE    a line for each event and each frame\n"
    "      --json FILE      phones, words and marks with their times\n"
    "      --arkit FILE     the face as weights of ARKit's 52 shapes, in Live Link Face's columns (CSV)\n"
    "      --arkit-ndjson FILE  the same weights as lines of JSON\n"
    "      --visemes FILE   visemes with their times, and the 15 weights of each frame (lines of JSON)\n"
    "      --vtt FILE       captions with word times; --textgrid FILE sentences, words, phones for Praat\n"
    "      --osc HOST:PORT  the face, as it goes on, to a puppet of the VMC protocol\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard input or output. Exit status: 0 spoken, 1 failed, 2 wrong usage.\n";

/* One file to be written. */
struct output {
    const char *path; /* NULL = not asked for, or it cannot be written */
    struct cli_file file;
    struct export export;
};

enum { WAV, FAP, JSON, OGG, NDJSON, FAPC, ARKIT, ARKIT_NDJSON, VISEMES, VTT, TEXTGRID, OUTPUTS };
enum { OUTPUT_OPTION = 256 }; /* of the first of them */
enum { HEARD = -2 };          /* a recording is to be heard: not for us */

struct say {
    struct cli cli;
    struct synthesis *synthesis;
    struct output outputs[OUTPUTS];
    const char *sounds, *puppet; /* NULL = none */
    struct osc_play *osc;
    struct cli_written written; /* of a text that is open */
    bool failed, finished, spoken;
};

static int flush(struct say *s, struct output *o) {
    struct buf *out = &o->export.out;
    if (!out->size || (fwrite(out->data, 1, out->size, o->file.file) == out->size && !fflush(o->file.file))) {
        out->size = 0;
        return 0;
    }
    cli_complain("%s: %s", o->path, strerror(errno));
    s->failed = true;
    o->path = NULL; /* one message is enough */
    return -1;
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct say *s = ctx;
    for (struct output *o = s->outputs; o < s->outputs + OUTPUTS; o++) {
        if (!o->path)
            continue;
        o->export.source.text = synthesis_request(s->synthesis)->text; /* it may have grown */
        export_segment(&o->export, &segment);
        if (o->export.format->streams)
            flush(s, o);
    }
    if (s->osc)
        osc_play_add(s->osc, &segment);
    media_segment_free(&segment);
    synthesis_release(s->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct say *s = ctx;
    char text[400];
    cli_complain("%s%s", warning ? "warning: " : "", error_text(e, text, sizeof text));
    s->failed |= !warning;
    for (struct output *o = s->outputs; o < s->outputs + OUTPUTS; o++)
        if (o->path)
            export_warning(&o->export, e);
}

/* A WAV file that can be rewound gets its true length; a pipe keeps "unknown". */
static void finish_wav(struct output *o) {
    uint8_t header[WAV_HEADER_BYTES];
    if (!o->export.sample_rate || fseek(o->file.file, 0, SEEK_SET))
        return;
    wav_header(header, o->export.sample_rate, o->export.samples);
    fwrite(header, 1, sizeof header, o->file.file);
}

static void on_finished(void *ctx, size_t spoken) {
    struct say *s = ctx;
    s->finished = true;
    s->failed |= !spoken;
    s->spoken = spoken;
    if (s->osc)
        osc_play_end(s->osc);
    for (struct output *o = s->outputs; o < s->outputs + OUTPUTS; o++) {
        if (!o->path)
            continue;
        export_end(&o->export);
        flush(s, o);
        if (o == &s->outputs[WAV])
            finish_wav(o);
    }
}

static int open_outputs(struct say *s) {
    const struct export_source source = export_source_of(s->synthesis);
    static const char *const names[OUTPUTS] = {"wav",   "fap",          "json",    "ogg", "ndjson",  "fapc",
                                               "arkit", "arkit-ndjson", "visemes", "vtt", "textgrid"};
    int standard = 0;
    bool asked = false;
    for (int i = 0; i < OUTPUTS; i++)
        asked |= s->outputs[i].path != NULL;
    if (s->puppet && !(s->osc = osc_play_open(&s->cli.loop, s->puppet, &source)))
        return EXIT_USAGE;
    if (!asked && !s->puppet)
        s->outputs[JSON].path = "-";
    for (int i = 0; i < OUTPUTS; i++) {
        struct output *o = &s->outputs[i];
        if (!o->path)
            continue;
        standard += !strcmp(o->path, "-");
        if (cli_create(&o->file, o->path))
            return EXIT_FAILED;
        export_begin(&o->export, export_by_name(names[i]), &source);
    }
    if (standard > 1) {
        cli_complain("only one file can go to standard output");
        return EXIT_USAGE;
    }
    return EXIT_DONE;
}

/* A sentence that failed costs itself; what nothing was said in, or could not be written, is no file. */
static void close_outputs(struct say *s) {
    for (struct output *o = s->outputs; o < s->outputs + OUTPUTS; o++) {
        s->failed |= cli_finish(&o->file, s->spoken && o->path) != 0;
        export_free(&o->export);
    }
}

/* The exit code, -1 to go on, or HEARD. */
static int parse(int argc, char **argv, struct say *s, struct speech_request *request, struct buf *text) {
    static const struct option options[] = {
        {"lang", 1, NULL, 'l'},
        {"voice", 1, NULL, 'v'},
        {"rate", 1, NULL, 'r'},
        {"pitch", 1, NULL, 1},
        {"gender", 1, NULL, 1},
        {"volume", 1, NULL, 1},
        {"fps", 1, NULL, 1},
        {"engine", 1, NULL, 'e'},
        {"markup", 1, NULL, 1},
        {"seed", 1, NULL, 1},
        {"still", 0, NULL, 1},
        {"life", 1, NULL, 1},
        {"blend", 1, NULL, 1},
        {"open", 0, NULL, 1},
        {"file", 1, NULL, 'f'},
        {"wav", 1, NULL, OUTPUT_OPTION + WAV},
        {"fap", 1, NULL, OUTPUT_OPTION + FAP},
        {"json", 1, NULL, OUTPUT_OPTION + JSON},
        {"audio", 1, NULL, 'A'},
        {"ogg", 1, NULL, OUTPUT_OPTION + OGG},
        {"ndjson", 1, NULL, OUTPUT_OPTION + NDJSON},
        {"fapc", 1, NULL, OUTPUT_OPTION + FAPC},
        {"arkit", 1, NULL, OUTPUT_OPTION + ARKIT},
        {"arkit-ndjson", 1, NULL, OUTPUT_OPTION + ARKIT_NDJSON},
        {"visemes", 1, NULL, OUTPUT_OPTION + VISEMES},
        {"vtt", 1, NULL, OUTPUT_OPTION + VTT},
        {"textgrid", 1, NULL, OUTPUT_OPTION + TEXTGRID},
        {"osc", 1, NULL, 'P'},
        {"contacts", 1, NULL, 1},
        {"normalize", 1, NULL, 1},
        {"voice-file", 1, NULL, 'S'},
        {"help", 0, NULL, 'h'},
        {0},
    };
    const char *path = NULL;
    struct error e;
    char message[400];
    for (int c, at; (at = -1, c = getopt_long(argc, argv, "l:v:r:e:f:h", options, &at)) != -1;) {
        for (int i = 0; at < 0 && options[i].name; i++)
            at = options[i].val == c ? i : -1;
        if (c >= OUTPUT_OPTION) {
            s->outputs[c - OUTPUT_OPTION].path = optarg;
            continue;
        }
        if (c == 'f' || c == 'A' || c == 'P') {
            *(c == 'f' ? &path : c == 'A' ? &s->sounds : &s->puppet) = optarg;
            continue;
        }
        switch (c) {
        case 'S':
            return HEARD;
        case 'h':
            fputs(usage, stdout);
            return EXIT_DONE;
        case '?':
            fputs("Try 'faccia say --help'.\n", stderr);
            return EXIT_USAGE;
        default: {
            const char *word = optarg ? optarg : "true";
            struct request_value value = {REQUEST_WORD, word, strlen(word), 0};
            if (request_set(request, options[at].name, value, &e)) {
                cli_complain("--%s", error_text(&e, message, sizeof message));
                return EXIT_USAGE;
            }
        }
        }
    }
    if (request->open && (path || optind + 1 != argc || strcmp(argv[optind], "-"))) {
        cli_complain("--open is for standard input (-)");
        return EXIT_USAGE;
    }
    if (request->open)
        return -1;
    int status = cli_text(argc, argv, path, text);
    if (status >= 0)
        return status;
    request_set(request, "text",
                (struct request_value){REQUEST_STRING, text->size ? (char *)text->data : "", text->size, 0},
                &e);
    return -1;
}

static int speak(struct say *s, const struct speech_request *request) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct error e;
    char message[400];
    s->cli.stages.pipeline.sounds = s->sounds ? s->sounds : s->cli.stages.pipeline.sounds;
    s->synthesis = synthesis_open(&s->cli.stages.pipeline, request, &callbacks, s, &e);
    if (!s->synthesis) {
        cli_complain("%s", error_text(&e, message, sizeof message));
        return e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
    }
    int status = open_outputs(s);
    if (!status) {
        synthesis_start(s->synthesis);
        if (request->open)
            cli_written_begin(&s->written, &s->cli.loop, s->synthesis);
        while ((!s->finished || (s->osc && osc_play_busy(s->osc))) && uv_run(&s->cli.loop, UV_RUN_ONCE))
            ;
    }
    close_outputs(s);
    osc_play_free(s->osc);
    s->failed |= s->written.failed;
    cli_written_end(&s->written);
    synthesis_free(s->synthesis);
    return status ? status : s->failed ? EXIT_FAILED : EXIT_DONE;
}

int say_main(int argc, char **argv, const struct settings *settings) {
    struct say s = {0};
    struct speech_request request;
    struct buf text = {0};
    request_init(&request);
    int status = parse(argc, argv, &s, &request, &text);
    if (status == HEARD) {
        optind = 0; /* from the beginning */
        status = hear_main(argc, argv, settings);
    } else if (status < 0) {
        status = cli_open(&s.cli, settings) ? EXIT_FAILED : speak(&s, &request);
        cli_close(&s.cli);
    }
    request_free(&request);
    buf_free(&text);
    return status;
}
