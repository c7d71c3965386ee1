/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia life: measures idle movement, in silence or while speaking a text. */
#include "protocol/fapfile.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include "server/face/life/life.h"
#include "server/research/life_statistics.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia life [OPTION]... [TEXT | --file FILE | -]\n"
    "Runs the face's idle motion, for some time without speech or while it speaks TEXT, and prints "
    "statistics of it:\n"
    "blinks, saccades, gaze and head movement. Only idle motion is counted.\n"
    "\n"
    "      --seconds N      duration without a text, 1 to 86400 (600)\n"
    "      --seed N         random seed: the same number gives the same motion (0)\n"
    "      --strength X     strength of the motion, 0 to 2; 1 is natural (1)\n"
    "  -l, --lang TAG       language of the text, any with a voice (it)\n"
    "  -f, --file FILE      the text\n"
    "      --fps N          frames per second, 25 to 1000 (100)\n"
    "      --fap FILE       the face, as MPEG-4 FAPs (text, version 2.1)\n"
    "  -h, --help           print this and exit\n"
    "FILE - is standard input or output. Exit status: 0 done, 1 failed, 2 wrong usage.\n";

struct life_run {
    double seconds, seed, strength, fps;
    const char *lang, *fap, *file;
    struct cli_file out;
    struct buf frames; /* speech, until the number of frames is known */
    struct cli cli;
    struct synthesis *synthesis;
    struct life_statistics statistics;
    bool finished, failed;
};

static void frame_of(const struct face_layer *layer, double t, struct fap_frame *frame) {
    double faps[FAP_COUNT + 1] = {0};
    layer->add(layer->self, t, faps);
    *frame = (struct fap_frame){0};
    for (int n = 3; n <= FAP_COUNT; n++)
        fap_frame_set(frame, n, fap_clamp(n, (int32_t)lround(faps[n])));
}

/* Samples the layer, which began at `begin`, up to `end`. */
static void live(struct life_run *r, const struct face_layer *layer, double begin, double end, bool speech) {
    struct fap_frame frame;
    char text[4096];
    for (double t; (t = (double)r->statistics.frames / r->fps) < end;) {
        frame_of(layer, t - begin, &frame);
        if (r->out.file) {
            size_t size = fapfile_write_frame(&frame, r->statistics.frames, text, sizeof text);
            if (speech)
                buf_add(&r->frames, text, size);
            else
                fputs(text, r->out.file);
        }
        life_statistics_add(&r->statistics, &frame);
    }
}

static void write_header(const struct life_run *r, size_t count) {
    char text[200];
    fapfile_write_header("faccia life", r->fps, count, text, sizeof text);
    if (r->out.file)
        fputs(text, r->out.file);
}

static void live_through(struct life_run *r, const struct sentence_audio *u, double begin, double seconds) {
    struct placement_options options = {.life = r->strength, .seed = (uint64_t)r->seed, .begin = begin};
    struct face_layer layer = life_layer(&options, u, (struct life_influence){0});
    live(r, &layer, begin, begin + seconds, u != NULL);
    if (layer.free)
        layer.free(layer.self);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct life_run *r = ctx;
    double rate = segment.audio->sample_rate;
    live_through(r, segment.audio, segment.start / rate, segment.audio->samples / rate);
    media_segment_free(&segment);
    synthesis_release(r->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct life_run *r = ctx;
    char text[400];
    cli_complain("%s%s", warning ? "warning: " : "", error_text(e, text, sizeof text));
    r->failed |= !warning;
}

static void on_finished(void *ctx, size_t spoken) {
    (void)spoken;
    ((struct life_run *)ctx)->finished = true;
}

static int speak(struct life_run *r, const struct settings *settings, const struct buf *text) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct speech_request request;
    struct error e;
    char message[400];
    request_init(&request);
    int wrong = request_set(&request, "text",
                            (struct request_value){REQUEST_STRING, (char *)text->data, text->size, 0}, &e);
    if (!wrong && r->lang)
        wrong = request_set(&request, "lang",
                            (struct request_value){REQUEST_WORD, r->lang, strlen(r->lang), 0}, &e);
    int status = EXIT_FAILED;
    if (!cli_open(&r->cli, settings)) {
        r->synthesis =
            wrong ? NULL : synthesis_open(&r->cli.components.pipeline, &request, &callbacks, r, &e);
        if (r->synthesis) {
            synthesis_start(r->synthesis);
            while (!r->finished && uv_run(&r->cli.loop, UV_RUN_ONCE))
                ;
            status = r->failed ? EXIT_FAILED : EXIT_DONE;
        } else {
            cli_complain("%s", error_text(&e, message, sizeof message));
            status = e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
        }
        synthesis_free(r->synthesis);
    }
    cli_close(&r->cli);
    request_free(&request);
    return status;
}

static void print_list(FILE *out, const char *name, const struct life_list *list) {
    fprintf(out, "%-18s n %5zu  mean %7.3f  deviation %7.3f  skewness %6.2f\n", name, list->count,
            life_list_mean(list), life_list_deviation(list), life_list_skewness(list));
}

static void report(const struct life_statistics *s, FILE *out) {
    static const char *const axes[] = {"pitch", "yaw", "roll"};
    double n = fmax(1, (double)s->frames), minutes = n / s->fps / 60;
    fprintf(out, "%-18s %.1f\n", "seconds", 60 * minutes);
    fprintf(out, "%-18s %.1f (%.0f %% incomplete)\n", "blinks/minute", (double)s->blinks / minutes,
            s->blinks ? 100.0 * (double)s->incomplete / (double)s->blinks : 0);
    print_list(out, "blink interval, s", &s->intervals);
    print_list(out, "blink duration, s", &s->durations);
    fprintf(out, "%-18s %.1f\n", "saccades/minute", (double)s->saccades.count / minutes);
    print_list(out, "saccade, degrees", &s->saccades);
    fprintf(out, "%-18s %.1f %% of the time\n", "at the listener", 100 * (double)s->at_listener / n);
    print_list(out, "glance away, s", &s->away);
    for (int i = 0; i < 3; i++) {
        double mean = s->sum[i] / n, deviation = sqrt(fmax(0, s->square[i] / n - mean * mean));
        fprintf(out,
                "head %-13s %.2f to %.2f degrees, deviation %.2f, speed up to %.1f /s, acceleration up to "
                "%.0f /s2\n",
                axes[i], s->low[i], s->high[i], deviation, s->speed[i], s->acceleration[i]);
    }
}

static int read_number(const char *name, const char *text, double min, double max, double *out) {
    char *end;
    *out = strtod(text, &end);
    if (end != text && !*end && *out >= min && *out <= max)
        return 0;
    cli_complain("--%s: must be a number from %g to %g", name, min, max);
    return -1;
}

/* Returns an exit code, or -1 to continue. */
static int parse(int argc, char **argv, struct life_run *r) {
    enum { HELP = 256, SECONDS, SEED, STRENGTH, FPS, FAP };
    static const struct option options[] = {
        {"seconds", 1, NULL, SECONDS}, {"seed", 1, NULL, SEED}, {"strength", 1, NULL, STRENGTH},
        {"lang", 1, NULL, 'l'},        {"file", 1, NULL, 'f'},  {"fps", 1, NULL, FPS},
        {"fap", 1, NULL, FAP},         {"help", 0, NULL, 'h'},  {0}};
    for (int c; (c = options_next(argc, argv, "l:f:h", options, NULL)) != -1;) {
        int wrong = 0;
        switch (c) {
        case SECONDS:
            wrong = read_number("seconds", optarg, 1, 86400, &r->seconds);
            break;
        case SEED:
            wrong = read_number("seed", optarg, 0, 4294967295.0, &r->seed);
            break;
        case STRENGTH:
            wrong = read_number("strength", optarg, 0, 2, &r->strength);
            break;
        case FPS:
            wrong = read_number("fps", optarg, 25, FAPFILE_FPS_MAX, &r->fps);
            break;
        case FAP:
            r->fap = optarg;
            break;
        case 'l':
            r->lang = optarg;
            break;
        case 'f':
            r->file = optarg;
            break;
        case 'h':
            fputs(usage, stdout);
            return EXIT_DONE;
        default:
            fputs("Try 'faccia life --help'.\n", stderr);
            return EXIT_USAGE;
        }
        if (wrong)
            return EXIT_USAGE;
    }
    return -1;
}

int life_main(int argc, char **argv, const struct settings *settings) {
    struct life_run r = {.seconds = 600, .strength = 1, .fps = 100};
    struct buf text = {0};
    int status = parse(argc, argv, &r);
    if (status >= 0)
        return status;
    bool speaks = r.file || optind < argc;
    if (speaks && (status = cli_text(argc, argv, r.file, &text)) >= 0)
        return status;
    if (r.fap && cli_create(&r.out, r.fap))
        return EXIT_FAILED;
    life_statistics_init(&r.statistics, r.fps);
    status = EXIT_DONE;
    if (speaks) {
        status = speak(&r, settings, &text);
        write_header(&r, r.statistics.frames);
        if (r.out.file)
            fwrite(r.frames.data, 1, r.frames.size, r.out.file);
    } else {
        write_header(&r, (size_t)ceil(r.seconds * r.fps));
        live_through(&r, NULL, 0, r.seconds);
    }
    if (cli_finish(&r.out, status == EXIT_DONE))
        status = EXIT_FAILED;
    if (status == EXIT_DONE)
        report(&r.statistics, r.fap && !strcmp(r.fap, "-") ? stderr : stdout);
    life_statistics_free(&r.statistics);
    buf_free(&r.frames);
    buf_free(&text);
    return status;
}
