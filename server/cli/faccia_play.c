/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia play: converts a recording, a .fap file and its sound, to the output formats of speech. */
#include "server/base/mem.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include "server/export/export.h"
#include "server/synthesis/recording.h"
#include <errno.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia play [OPTION]... FILE.fap [SOUND]\n"
    "Reads a face animation and its sound (any format of libsndfile; default: a file of the same name beside "
    "it,\n"
    "or silence) as the daemon does, and converts it. Without an output file, lines of JSON go to standard "
    "output.\n"
    "\n"
    "      --ndjson FILE    a line for each frame\n"
    "      --wav FILE       the sound, mono, 16 bits\n"
    "      --ogg FILE       the sound, as Opus in Ogg\n"
    "      --fap FILE       the face, as MPEG-4 FAPs (text, version 2.1)\n"
    "      --fapc FILE      the same, at a few kilobits per second\n"
    "      --arkit FILE     weights of ARKit's 52 shapes, in the columns of Live Link Face (CSV)\n"
    "      --arkit-ndjson FILE  the same weights as lines of JSON\n"
    "      --visemes FILE   the 15 visemes of FAP 1, frame by frame (lines of JSON)\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard output. Exit status: 0 done, 1 failed, 2 wrong usage.\n";

enum { OUTPUTS = 8 };
static const char *const names[OUTPUTS] = {"ndjson", "wav",   "ogg",          "fap",
                                           "fapc",   "arkit", "arkit-ndjson", "visemes"};

struct play {
    struct recording *recording;
    struct {
        const char *path; /* NULL = not requested */
        struct cli_file file;
        struct export export;
    } outputs[OUTPUTS];
    const char *fap; /* the recorded face */
    bool failed, finished;
};

static void flush(struct play *p, int i) {
    struct buf *out = &p->outputs[i].export.out;
    p->failed |= fwrite(out->data, 1, out->size, p->outputs[i].file.file) != out->size;
    out->size = 0;
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct play *p = ctx;
    for (int i = 0; i < OUTPUTS; i++) {
        if (!p->outputs[i].path)
            continue;
        p->outputs[i].export.fps = recording_fps(p->recording);
        export_segment(&p->outputs[i].export, &segment);
        if (p->outputs[i].export.format->streams)
            flush(p, i);
    }
    media_segment_free(&segment);
    recording_release(p->recording);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct play *p = ctx;
    cli_complain_at(p->fap, warning, e);
    p->failed |= !warning;
}

static void on_finished(void *ctx, size_t pieces) {
    struct play *p = ctx;
    p->finished = true;
    for (int i = 0; i < OUTPUTS && pieces; i++)
        if (p->outputs[i].path) {
            export_end(&p->outputs[i].export);
            flush(p, i);
        }
}

static int open_outputs(struct play *p, const char *name) {
    const struct export_source source = {.play = name};
    int standard = 0;
    bool asked = false;
    for (int i = 0; i < OUTPUTS; i++)
        asked |= p->outputs[i].path != NULL;
    if (!asked)
        p->outputs[0].path = "-";
    for (int i = 0; i < OUTPUTS; i++) {
        if (!p->outputs[i].path)
            continue;
        standard += !strcmp(p->outputs[i].path, "-");
        if (cli_create(&p->outputs[i].file, p->outputs[i].path))
            return EXIT_FAILED;
        export_begin(&p->outputs[i].export, export_by_name(names[i]), &source);
    }
    if (standard > 1)
        cli_complain("only one file can go to standard output");
    return standard > 1 ? EXIT_USAGE : EXIT_DONE;
}

static void close_outputs(struct play *p, bool well) {
    for (int i = 0; i < OUTPUTS; i++) {
        p->failed |= cli_finish(&p->outputs[i].file, well) != 0;
        export_free(&p->outputs[i].export);
    }
}

static int run(struct play *p, const struct settings *settings, const char *fap, const char *sound) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct recording_source source = {.name = mem_strdup(fap),
                                      .fap_path = mem_strdup(fap),
                                      .sound_path = sound ? mem_strdup(sound) : NULL,
                                      .fap_bytes_max = (size_t)1 << 30};
    struct components components;
    uv_loop_t loop;
    int status = open_outputs(p, fap);
    uv_loop_init(&loop);
    if (!status && cli_load(&components, settings, COMPONENTS_SPEECH | COMPONENTS_EXPRESSIONS, &loop)) {
        components_free(&components);
        status = EXIT_FAILED;
    }
    if (status) {
        recording_source_free(&source);
        close_outputs(p, false);
        uv_loop_close(&loop);
        return status;
    }
    p->recording = recording_open(&loop, components.pipeline.high_level, NULL, NULL, &source, &callbacks, p);
    recording_start(p->recording);
    while (!p->finished && uv_run(&loop, UV_RUN_ONCE))
        ;
    close_outputs(p, !p->failed);
    recording_free(p->recording);
    uv_run(&loop, UV_RUN_DEFAULT);
    uv_loop_close(&loop);
    components_free(&components);
    return p->failed ? EXIT_FAILED : EXIT_DONE;
}

int play_main(int argc, char **argv, const struct settings *settings) {
    static const struct option options[] = {{"ndjson", 1, NULL, 0},       {"wav", 1, NULL, 1},
                                            {"ogg", 1, NULL, 2},          {"fap", 1, NULL, 3},
                                            {"fapc", 1, NULL, 4},         {"arkit", 1, NULL, 5},
                                            {"arkit-ndjson", 1, NULL, 6}, {"visemes", 1, NULL, 7},
                                            {"help", 0, NULL, 'h'},       {0}};
    struct play p = {0};
    for (int c; (c = options_next(argc, argv, "h", options, NULL)) != -1;) {
        if (c == 'h') {
            fputs(usage, stdout);
            return EXIT_DONE;
        }
        if (c >= OUTPUTS) {
            fputs("Try 'faccia play --help'.\n", stderr);
            return EXIT_USAGE;
        }
        p.outputs[c].path = optarg;
    }
    if (argc - optind < 1 || argc - optind > 2) {
        cli_complain("expected one .fap file, and at most one sound file");
        return EXIT_USAGE;
    }
    for (int i = optind; i < argc; i++)
        if (access(argv[i], R_OK)) {
            cli_complain("%s: %s", argv[i], strerror(errno));
            return EXIT_FAILED;
        }
    p.fap = argv[optind];
    return run(&p, settings, argv[optind], argv[optind + 1]);
}
