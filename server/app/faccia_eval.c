/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia eval: the same speech at several rates, its lips made by each engine and measured. */
#include "server/app/cli.h"
#include "server/app/cli_file.h"
#include "server/app/eval_options.h"
#include "server/app/eval_recordings.h"
#include "server/base/mem.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct run {
    struct cli cli;
    struct eval_options options;
    struct synthesis *synthesis;
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
    const struct speech_pack *pack = speech_packs_find(&run->cli.packs, synthesis_lang(run->synthesis));
    struct face_options options = {
        .engine = r->engines[engine].engine, .still = true, .contacts = r->engines[engine].contacts};
    struct face_track *track = face_track_new(pack, segment->audio, &options, NULL, NULL);
    struct eval_input in = {.pack = pack,
                            .audio = segment->audio,
                            .text = run->options.request.text,
                            .face = {sample, track},
                            .fps = run->options.request.fps,
                            .start = (double)segment->start / segment->audio->sample_rate};
    eval_add(&r->evals[engine * r->rate_count + run->rate], &in);
    if (chosen)
        stretch_take(run->rate ? &r->fast : &r->slow, &run->choice, &in, engine);
    face_track_free(track);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct run *run = ctx;
    const struct speech_pack *pack = speech_packs_find(&run->cli.packs, synthesis_lang(run->synthesis));
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
    run->options.request.rate = run->options.rates[run->rate];
    run->segment = 0;
    run->finished = false;
    run->synthesis = synthesis_open(&run->cli.pipeline, &run->options.request, &callbacks, run, &e);
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

static int write_report(struct run *run) {
    const struct eval_report *r = &run->report;
    struct buf svg = {0};
    struct cli_file file;
    int status = EXIT_DONE;
    if (!run->options.json_path && !run->options.svg_path)
        eval_report_table(r, stdout);
    if (run->options.json_path) {
        int failed = cli_create(&file, run->options.json_path);
        if (!failed)
            eval_report_json(r, file.file);
        if (failed || cli_finish(&file, true))
            status = EXIT_FAILED;
    }
    if (run->options.svg_path) {
        eval_report_svg(r, &svg);
        int failed = cli_create(&file, run->options.svg_path);
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
    const struct eval_options *o = &run->options;
    struct error e;
    char message[400];
    for (const char *const *engine = face_engines(); *engine; engine++) {
        if (!eval_options_name(o, *engine))
            continue;
        if (!cli_try_engine(&run->cli, &o->request, *engine, &e)) {
            eval_options_variants(o, *engine, r->engines, &r->engine_count);
        } else if (o->engine_count || e.place != PLACE_FIELD || strcmp(e.field, "engine") != 0) {
            cli_complain("%s", error_text(&e, message, sizeof message));
            return e.place == PLACE_FIELD ? EXIT_USAGE : EXIT_FAILED;
        }
    }
    for (const char *const *engine = face_engine_ablations(); *engine; engine++)
        if (o->ablation || (o->engine_count && eval_options_name(o, *engine)))
            eval_options_variants(o, *engine, r->engines, &r->engine_count);
    return EXIT_DONE;
}

static int evaluate(struct run *run) {
    struct eval_report *r = &run->report;
    r->rate_count = run->options.rate_count;
    int status = choose_engines(run);
    if (status)
        return status;
    size_t rows = r->engine_count * r->rate_count;
    r->rates = run->options.rates;
    r->fps = run->options.request.fps;
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

int eval_main(int argc, char **argv) {
    struct run *run = mem_alloc(sizeof *run);
    struct buf text = {0};
    request_init(&run->options.request);
    int status = eval_options_parse(argc, argv, &run->options, &text);
    if (status < 0 && run->options.people) {
        status = eval_recordings(&run->options);
    } else if (status < 0) {
        status = cli_open(&run->cli) ? EXIT_FAILED : evaluate(run);
        cli_close(&run->cli);
    }
    request_free(&run->options.request);
    buf_free(&text);
    free(run);
    return status;
}
