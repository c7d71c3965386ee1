/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia timed: makes the face for recorded speech from a timed transcription, without a voice. */
#include "protocol/fapfile.h"
#include "server/base/buf.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include "server/face/packs/transcription.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] = "Usage: faccia timed [OPTION]... FILE\n"
                            "Writes the face of a timed phonetic transcription to standard output, as MPEG-4 "
                            "FAPs (text, version 2.1).\n"
                            "Each line of FILE is 'INDEX: OFFSET SYMBOL', OFFSET being the phone's first "
                            "byte in the sound file; the last\n"
                            "line has no symbol.\n"
                            "\n"
                            "  -l, --lang TAG      a language with a table of visemes (pt-BR)\n"
                            "  -e, --engine NAME   visible-speech engine (context)\n"
                            "      --fps N         frames per second, 1 to 120 (30)\n"
                            "      --header BYTES  bytes of the sound file before its first sample (44)\n"
                            "      --hz RATE       sample rate of the sound file (16000)\n"
                            "      --frame BYTES   bytes of one sample of all channels (2)\n";

struct timed {
    const char *lang, *engine;
    double fps, header, hz, frame;
};

static int read_number(const char *name, const char *text, double min, double max, double *out) {
    char *end;
    *out = strtod(text, &end);
    if (end == text || *end || !(*out >= min && *out <= max)) {
        cli_complain("--%s: must be a number from %g to %g", name, min, max);
        return -1;
    }
    return 0;
}

static void on_warning(void *ctx, const char *message) {
    (void)ctx;
    cli_complain("%s", message);
}

static int write_face(const struct timed *o, const struct speech_pack *pack, const struct sentence_audio *u) {
    struct face_options options = {.engine = o->engine, .still = true};
    struct face_track *track = face_track_new(pack, u, &options, on_warning, NULL);
    uint32_t count = frame_from_sample(u->samples, u->sample_rate, o->fps);
    char text[4096];
    fapfile_write_header("faccia", o->fps, count, text, sizeof text);
    fputs(text, stdout);
    for (uint32_t k = 0; k < count; k++) {
        struct fap_frame frame;
        face_track_sample(track, k / o->fps, &frame);
        fapfile_write_frame(&frame, k, text, sizeof text);
        fputs(text, stdout);
    }
    face_track_free(track);
    if (fflush(stdout)) {
        cli_complain("standard output: %s", strerror(errno));
        return EXIT_FAILED;
    }
    return EXIT_DONE;
}

static int run(const struct timed *o, const char *path, const struct speech_packs *packs) {
    const struct speech_pack *pack = speech_packs_find(packs, o->lang);
    if (!pack) {
        cli_complain("lang: unknown language '%s'", o->lang);
        return EXIT_USAGE;
    }
    if (!face_engine_speaks(o->engine, pack)) {
        cli_complain("engine: unknown engine '%s' for '%s'", o->engine, o->lang);
        return EXIT_USAGE;
    }
    struct transcription_sound sound = {(size_t)o->header, (uint32_t)o->hz, (size_t)o->frame};
    struct buf text = {0};
    struct error e;
    char message[400];
    int result = EXIT_FAILED;
    if (!cli_read(path, &text)) {
        struct sentence_audio *u = transcription_read((const char *)text.data, text.size, &sound, pack, &e);
        if (u)
            result = write_face(o, pack, u);
        else
            cli_complain("%s:%s", path, error_text(&e, message, sizeof message));
        sentence_audio_free(u);
    }
    buf_free(&text);
    return result;
}

int timed_main(int argc, char **argv, const struct settings *settings) {
    enum { HELP = 256, FPS, HEADER, HERTZ, FRAME };
    static const struct option options[] = {{"lang", 1, NULL, 'l'},  {"engine", 1, NULL, 'e'},
                                            {"fps", 1, NULL, FPS},   {"header", 1, NULL, HEADER},
                                            {"hz", 1, NULL, HERTZ},  {"frame", 1, NULL, FRAME},
                                            {"help", 0, NULL, HELP}, {0}};
    struct timed o = {"pt-BR",
                      "context",
                      30,
                      (double)transcription_wav.header,
                      transcription_wav.rate,
                      (double)transcription_wav.frame};
    for (int c; (c = options_next(argc, argv, "l:e:h", options, NULL)) != -1;) {
        bool wrong = false;
        switch (c) {
        case 'l':
            o.lang = optarg;
            break;
        case 'e':
            o.engine = optarg;
            break;
        case FPS:
            wrong = read_number("fps", optarg, 1, 120, &o.fps);
            break;
        case HEADER:
            wrong = read_number("header", optarg, 0, 1e9, &o.header);
            break;
        case HERTZ:
            wrong = read_number("hz", optarg, 1000, 192000, &o.hz);
            break;
        case FRAME:
            wrong = read_number("frame", optarg, 1, 64, &o.frame);
            break;
        case 'h':
        case HELP:
            fputs(usage, stdout);
            return EXIT_DONE;
        default:
            wrong = true;
        }
        if (wrong)
            return EXIT_USAGE;
    }
    if (optind + 1 != argc) {
        cli_complain("one file is needed");
        return EXIT_USAGE;
    }
    struct components components;
    int result = cli_load(&components, settings, COMPONENTS_SPEECH, NULL)
                     ? EXIT_FAILED
                     : run(&o, argv[optind], &components.packs);
    components_free(&components);
    return result;
}
