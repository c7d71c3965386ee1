/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia eval: the same speech at several rates, its lips made by each engine and measured. */
#include "server/app/cli.h"
#include "server/app/cli_file.h"
#include "server/app/eval_report.h"
#include "server/base/mem.h"
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: faccia eval [OPTION]... (TEXT | --file FILE | -)\n"
    "Measures how well lips can be read that speak TEXT, a file, or standard input (-), for each engine and "
    "speech rate.\n"
    "Without --json or --svg a table goes to standard output.\n"
    "\n"
    "  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)\n"
    "  -v, --voice ID       a voice that 'faccia voices' lists\n"
    "  -e, --engine NAME    visible-speech engine; may be given several times (all that the language has)\n"
    "  -r, --rates LIST     words per minute, 40 to 500, with commas (80,120,160,200,240,280,320)\n"
    "      --fps N          FAP frames per second, 1 to 120 (25)\n"
    "  -f, --file FILE      the text\n"
    "      --json FILE      all figures\n"
    "      --svg FILE       a picture: the lips' gap over some words, and the measures over the rates\n"
    "  -h, --help           print this and exit\n"
    "\n"
    "lips, held: bilabials closed in a frame, throughout their closure; teeth, held: the same for "
    "labiodentals;\n"
    "open, err: opening of vowels against their targets; round, protr: rounding of /o u/ against its "
    "targets; antic: how\n"
    "much of it is there in the consonant before; speed, jerk: the largest of the lips' gap; overlap: lips "
    "passing through\n"
    "each other; reader: visemes told by a nearest-neighbour reader that learnt from half of the words; "
    "usual: the same by\n"
    "always saying the commonest one. How they are taken: server/eval/eval.h.\n"
    "FILE - is standard input or output. Exit status: 0 measured, 1 failed, 2 wrong usage.\n";

enum { MAX_RATES = 32 };

struct run {
    struct cli cli;
    struct speech_request request;
    struct synthesis *synthesis;
    const char *json_path, *svg_path;
    double rates[MAX_RATES];
    struct eval_report report;
    struct stretch_choice choice;
    size_t rate, segment; /* the present ones */
    bool finished, failed;
};

static void sample(void *track, double t, struct fap_frame *frame) {
    face_track_sample(track, t, frame);
}

static void measure(struct run *run, const struct media_segment *segment, size_t engine, bool chosen) {
    struct eval_report *r = &run->report;
    const struct speech_pack *pack =
        speech_packs_find(&run->cli.stages.packs, synthesis_lang(run->synthesis));
    struct face_options options = {.engine = r->engines[engine], .still = true};
    struct face_track *track = face_track_new(pack, segment->audio, &options, NULL, NULL);
    struct eval_input in = {.pack = pack,
                            .audio = segment->audio,
                            .text = run->request.text,
                            .face = {sample, track},
                            .fps = run->request.fps,
                            .start = (double)segment->start / segment->audio->sample_rate};
    eval_add(&r->evals[engine * r->rate_count + run->rate], &in);
    if (chosen)
        stretch_take(run->rate ? &r->fast : &r->slow, &run->choice, &in, engine);
    face_track_free(track);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct run *run = ctx;
    const struct speech_pack *pack =
        speech_packs_find(&run->cli.stages.packs, synthesis_lang(run->synthesis));
    bool chosen = run->rate ? run->rate + 1 == run->report.rate_count && run->segment == run->choice.sentence
                            : stretch_choose(&run->choice, pack, segment.audio, run->segment);
    for (size_t i = 0; i < run->report.engine_count; i++)
        measure(run, &segment, i, chosen);
    run->segment++;
    media_segment_free(&segment);
    synthesis_release(run->synthesis);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    struct run *run = ctx;
    char text[400];
    if (warning && run->rate) /* every rate has the same ones */
        return;
    cli_complain("%s%s", warning ? "warning: " : "", error_text(e, text, sizeof text));
    run->failed |= !warning;
}

static void on_finished(void *ctx, size_t spoken) {
    struct run *run = ctx;
    run->finished = true;
    run->failed |= !spoken;
}

/* Speaks the text at the present rate. */
static int speak(struct run *run) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct error e;
    char message[400];
    run->request.rate = run->report.rates[run->rate];
    run->segment = 0;
    run->finished = false;
    run->synthesis = synthesis_open(&run->cli.stages.pipeline, &run->request, &callbacks, run, &e);
    if (!run->synthesis) {
        cli_complain("%s", error_text(&e, message, sizeof message));
        return e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
    }
    run->report.lang = synthesis_lang(run->synthesis);
    run->report.voice = synthesis_voice(run->synthesis)->id;
    synthesis_start(run->synthesis);
    while (!run->finished && uv_run(&run->cli.loop, UV_RUN_ONCE))
        ;
    synthesis_free(run->synthesis);
    return run->failed ? EXIT_FAILED : EXIT_DONE;
}

static int add_engine(struct eval_report *r, const char *name) {
    const char *const *engine = face_engines();
    while (*engine && strcmp(*engine, name) != 0)
        engine++;
    if (!*engine) {
        cli_complain("engine: no engine '%s'", name);
        return EXIT_USAGE;
    }
    for (size_t i = 0; i < r->engine_count; i++)
        if (r->engines[i] == *engine)
            return -1;
    if (r->engine_count == STRETCH_ENGINES) {
        cli_complain("--engine: at most %d", STRETCH_ENGINES);
        return EXIT_USAGE;
    }
    r->engines[r->engine_count++] = *engine;
    return -1;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static int read_rates(struct run *run, const char *list) {
    struct eval_report *r = &run->report;
    size_t kept = 0;
    for (r->rate_count = 0;; list++) {
        char *end;
        double rate = strtod(list, &end);
        if (end == list || (*end && *end != ',') || !(rate >= 40 && rate <= 500) ||
            r->rate_count == MAX_RATES) {
            cli_complain("--rates: must be up to %d numbers from 40 to 500 with commas between them",
                         MAX_RATES);
            return EXIT_USAGE;
        }
        run->rates[r->rate_count++] = rate;
        list = end;
        if (!*list)
            break;
    }
    qsort(run->rates, r->rate_count, sizeof *run->rates, compare);
    for (size_t i = 0; i < r->rate_count; i++)
        if (!kept || run->rates[i] != run->rates[kept - 1])
            run->rates[kept++] = run->rates[i];
    r->rate_count = kept;
    return -1;
}

/* The exit code, or -1 to go on. */
static int parse(int argc, char **argv, struct run *run, struct buf *text) {
    static const struct option options[] = {
        {"lang", 1, NULL, 'l'},   {"voice", 1, NULL, 'v'},
        {"engine", 1, NULL, 'e'}, {"rates", 1, NULL, 'r'},
        {"fps", 1, NULL, 'p'},    {"file", 1, NULL, 'f'},
        {"json", 1, NULL, 'J'},   {"svg", 1, NULL, 'S'},
        {"help", 0, NULL, 'h'},   {0},
    };
    const char *path = NULL;
    struct error e;
    char message[400];
    int status = read_rates(run, "80,120,160,200,240,280,320");
    for (int c; status < 0 && (c = getopt_long(argc, argv, "l:v:e:r:f:h", options, NULL)) != -1;) {
        const char *field = c == 'l' ? "lang" : c == 'v' ? "voice" : c == 'p' ? "fps" : NULL;
        if (field) {
            struct request_value value = {REQUEST_WORD, optarg, strlen(optarg), 0};
            if (!request_set(&run->request, field, value, &e))
                continue;
            cli_complain("--%s", error_text(&e, message, sizeof message));
            return EXIT_USAGE;
        }
        switch (c) {
        case 'e':
            status = add_engine(&run->report, optarg);
            break;
        case 'r':
            status = read_rates(run, optarg);
            break;
        case 'f':
            path = optarg;
            break;
        case 'J':
            run->json_path = optarg;
            break;
        case 'S':
            run->svg_path = optarg;
            break;
        case 'h':
            fputs(usage, stdout);
            return EXIT_DONE;
        default:
            fputs("Try 'faccia eval --help'.\n", stderr);
            return EXIT_USAGE;
        }
    }
    if (status >= 0)
        return status;
    if (run->json_path && run->svg_path && !strcmp(run->json_path, "-") && !strcmp(run->svg_path, "-")) {
        cli_complain("only one of --json and --svg can go to standard output");
        return EXIT_USAGE;
    }
    status = cli_text(argc, argv, path, text);
    if (status < 0)
        request_set(
            &run->request, "text",
            (struct request_value){REQUEST_STRING, text->size ? (char *)text->data : "", text->size, 0}, &e);
    return status;
}

static int write_report(struct run *run) {
    const struct eval_report *r = &run->report;
    struct buf svg = {0};
    struct cli_file file;
    int status = EXIT_DONE;
    if (!run->json_path && !run->svg_path)
        eval_report_table(r, stdout);
    if (run->json_path) {
        int failed = cli_create(&file, run->json_path);
        if (!failed)
            eval_report_json(r, file.file);
        if (failed || cli_finish(&file, true))
            status = EXIT_FAILED;
    }
    if (run->svg_path) {
        eval_report_svg(r, &svg);
        int failed = cli_create(&file, run->svg_path);
        if (!failed)
            fwrite(svg.data, 1, svg.size, file.file);
        if (failed || cli_finish(&file, true))
            status = EXIT_FAILED;
    }
    buf_free(&svg);
    return status;
}

/* Without --engine: those that can speak this. Otherwise each that was named must. */
static int choose_engines(struct run *run) {
    struct eval_report *r = &run->report;
    struct error e;
    char message[400];
    bool all = !r->engine_count;
    for (const char *const *engine = face_engines(); all && *engine && r->engine_count < STRETCH_ENGINES;
         engine++)
        r->engines[r->engine_count++] = *engine;
    for (size_t i = 0; i < r->engine_count;) {
        if (!cli_try_engine(&run->cli, &run->request, r->engines[i], &e)) {
            i++;
        } else if (all && e.place == PLACE_FIELD && !strcmp(e.field, "engine")) {
            memmove(r->engines + i, r->engines + i + 1, (--r->engine_count - i) * sizeof *r->engines);
        } else {
            cli_complain("%s", error_text(&e, message, sizeof message));
            return e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
        }
    }
    return EXIT_DONE;
}

static int evaluate(struct run *run) {
    struct eval_report *r = &run->report;
    int status = choose_engines(run);
    if (status)
        return status;
    size_t rows = r->engine_count * r->rate_count;
    r->rates = run->rates;
    r->fps = run->request.fps;
    r->evals = mem_alloc(rows * sizeof *r->evals);
    r->values = mem_alloc(rows * sizeof *r->values);
    for (run->rate = 0; !status && run->rate < r->rate_count; run->rate++)
        status = speak(run);
    for (size_t i = 0; !status && i < rows; i++)
        eval_values(&r->evals[i], r->values[i]);
    if (!status)
        status = write_report(run);
    for (size_t i = 0; i < rows; i++)
        eval_free(&r->evals[i]);
    stretch_free(&r->slow);
    stretch_free(&r->fast);
    free(r->evals);
    free(r->values);
    return status;
}

int eval_main(int argc, char **argv, const struct settings *settings) {
    struct run *run = mem_alloc(sizeof *run);
    struct buf text = {0};
    request_init(&run->request);
    int status = parse(argc, argv, run, &text);
    if (status < 0) {
        status = cli_open(&run->cli, settings) ? EXIT_FAILED : evaluate(run);
        cli_close(&run->cli);
    }
    request_free(&run->request);
    buf_free(&text);
    free(run);
    return status;
}
