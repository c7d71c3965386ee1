/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/cli/cli.h"
#include "server/daemon/components.h"
#include "server/daemon/settings.h"
#include "server/face/packs/speech_pack.h"
#include "server/research/eval_options.h"
#include "server/research/fit_read.h"
#include "server/research/person.h"
#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- faccia eval --recording: compares engines with recorded speakers ---- */

enum { OTHER = STRETCH_ENGINES, LINES };

/* Sums over the recordings for one line of the table. */
struct line {
    double count[PERSON_MEASURES],
        sum[PERSON_MEASURES][6]; /* r, rms, affine, shift, and r and rms after the shift */
    struct lip_reader reader;
    struct lip_reader_result read;
    bool there;
};

struct recordings {
    const struct eval_options *options;
    const struct speech_pack *pack;
    struct measured_speech *people, *others;
    struct eval_variant variants[STRETCH_ENGINES];
    size_t variant_count;
    bool use[PERSON_MEASURES]; /* measures that all recordings have; input of the lip reader */
    struct line lines[LINES];
    struct cli_file table; /* of frames; its file is NULL when none is wanted */
};

/* Words per minute actually spoken, including pauses. */
static double spoken_rate(const struct eval *e) {
    return e->seconds > 0 ? 60 * (double)e->words / e->seconds : NAN;
}

static void print_value(FILE *file, const struct eval_measure *m, double value) {
    static const struct {
        double factor;
        int decimals;
    } forms[] = {[EVAL_SHARE] = {100, 1},
                 [EVAL_RATIO] = {100, 1},
                 [EVAL_MM] = {1, 2},
                 [EVAL_SPEED] = {1, 0},
                 [EVAL_JERK] = {1e-3, 0}};
    if (isnan(value))
        fprintf(file, " %7s", "-");
    else
        fprintf(file, " %7.*f", forms[m->unit].decimals, value * forms[m->unit].factor);
}

static void eval_report_table(const struct eval_report *r, FILE *file) {
    static const char *const units[] = {"%", "%", "mm", "mm/s", "m/s3"};
    fprintf(file, "%s, %s, %g frames a second\n\n%-26s %5s %6s", r->voice, r->lang, r->fps, "engine", "rate",
            "spoken");
    for (int m = 0; m < EVAL_MEASURES; m++)
        fprintf(file, " %7s", eval_measures[m].head);
    fprintf(file, "\n%-26s %5s %6s", "", "wpm", "wpm");
    for (int m = 0; m < EVAL_MEASURES; m++)
        fprintf(file, " %7s", units[eval_measures[m].unit]);
    fputc('\n', file);
    for (size_t i = 0; i < r->engine_count * r->rate_count; i++) {
        fprintf(file, "%-26s %5g %6.0f", r->engines[i / r->rate_count].label, r->rates[i % r->rate_count],
                spoken_rate(&r->evals[i]));
        for (int m = 0; m < EVAL_MEASURES; m++)
            print_value(file, &eval_measures[m], r->values[i][m]);
        fputc('\n', file);
    }
}

static json_t *number(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *row(const struct eval_report *r, size_t i) {
    const struct eval *e = &r->evals[i];
    json_t *object =
        json_pack("{ss ss sf so sf sI sI sI sI}", "engine", r->engines[i / r->rate_count].engine, "contacts",
                  r->engines[i / r->rate_count].contacts == CONTACTS_ON ? "on" : "off", "rate",
                  r->rates[i % r->rate_count], "spoken_rate", number(spoken_rate(e)), "seconds", e->seconds,
                  "words", (json_int_t)e->words, "phones", (json_int_t)e->phones, "bilabials",
                  (json_int_t)e->lips.count, "labiodentals", (json_int_t)e->teeth.count);
    for (int m = 0; m < EVAL_MEASURES; m++)
        json_object_set_new(object, eval_measures[m].name, number(r->values[i][m]));
    return object;
}

static void eval_report_json(const struct eval_report *r, FILE *file) {
    static const char *const units[] = {"share", "ratio", "mm", "mm/s", "mm/s^3"};
    json_t *rows = json_array(), *measures = json_object();
    for (int m = 0; m < EVAL_MEASURES; m++)
        json_object_set_new(
            measures, eval_measures[m].name,
            json_pack("{ss ss}", "title", eval_measures[m].title, "unit", units[eval_measures[m].unit]));
    for (size_t i = 0; i < r->engine_count * r->rate_count; i++)
        json_array_append_new(rows, row(r, i));
    json_t *all = json_pack("{ss ss sf so so}", "lang", r->lang, "voice", r->voice, "fps", r->fps, "measures",
                            measures, "rows", rows);
    json_dumpf(all, file, JSON_INDENT(1) | JSON_REAL_PRECISION(7));
    fputc('\n', file);
    json_decref(all);
}

static void eval_report_svg(const struct eval_report *r, struct buf *out) {
    char title[200];
    const char *labels[STRETCH_ENGINES];
    for (size_t i = 0; i < r->engine_count; i++)
        labels[i] = r->engines[i].label;
    snprintf(title, sizeof title, "How well the lips can be read: %s, %s, %g frames a second", r->lang,
             r->voice, r->fps);
    struct plot plot = {.title = title,
                        .engines = labels,
                        .engine_count = r->engine_count,
                        .rates = r->rates,
                        .rate_count = r->rate_count,
                        .values = (const double(*)[EVAL_MEASURES])r->values,
                        .slow = &r->slow,
                        .fast = r->rate_count > 1 ? &r->fast : NULL};
    plot_draw(&plot, out);
}

static const char *const figures[] = {"r", "rms", "affine_rms", "shift", "shifted_r", "shifted_rms"};

/* Label of a line, or NULL if it is empty. */
static const char *label(const struct recordings *r, size_t line) {
    if (!r->lines[line].there)
        return NULL;
    return line == OTHER ? "another person" : r->variants[line].label;
}

/* Share of the people's frames in which a parameter was seen, not estimated. */
static double seen(const struct recordings *r, int param) {
    size_t frames = 0, estimated = 0;
    for (size_t i = 0; i < r->options->people; i++) {
        const struct measured_speech *person = &r->people[i];
        frames += person->frame_count;
        for (size_t k = 0; person->unseen[param] && k < person->frame_count; k++)
            estimated += person->unseen[param][k];
    }
    return 1 - (double)estimated / (double)frames;
}

/* Writes a measure's heading: a film does not show every parameter in all pictures. */
static const char *heading(const struct recordings *r, int measure, char text[32]) {
    double share = measure == PERSON_APERTURE ? fmin(seen(r, PARAM_LI), seen(r, PARAM_LS)) : seen(r, measure);
    if (share == 1)
        snprintf(text, 32, "%s", person_measures[measure]);
    else
        snprintf(text, 32, "%s, seen in %.0f %%", person_measures[measure], 100 * share);
    return text;
}

static void print(const struct recordings *r, FILE *out) {
    static const int order[] = {PERSON_APERTURE, PARAM_LI, PARAM_LS, PARAM_AR, PARAM_PI,
                                PARAM_PS,        PARAM_EM, PARAM_TH, PARAM_TA, PARAM_TB};
    fprintf(out, "%zu recordings, %s, predictions delayed by %g ms\n", r->options->people,
            speech_pack_lang(r->pack), r->options->shift * 1000);
    for (size_t k = 0; k < sizeof order / sizeof *order; k++) {
        int m = order[k];
        bool headed = false;
        char text[32];
        for (size_t i = 0; i < LINES; i++) {
            const struct line *line = &r->lines[i];
            if (!label(r, i) || !line->count[m])
                continue;
            if (!headed)
                fprintf(out, "\n%-33s %6s %7s %7s   %6s %6s %7s\n", heading(r, m, text), "r", "rms", "affine",
                        "shift", "r", "rms");
            headed = true;
            double n = line->count[m];
            const double *s = line->sum[m];
            fprintf(out, "%-33s %6.2f %7.2f %7.2f   %6.0f %6.2f %7.2f\n", label(r, i), s[0] / n, s[1] / n,
                    s[2] / n, s[3] / n, s[4] / n, s[5] / n);
        }
    }
    fprintf(out, "\n%-33s %6s %7s %7s\n", "reader, trained on people", "right", "of", "usual");
    for (size_t i = 0; i < LINES; i++)
        if (label(r, i))
            fprintf(out, "%-33s %6zu %7zu %7zu\n", label(r, i), r->lines[i].read.right, r->lines[i].read.read,
                    r->lines[i].read.usual);
}

static json_t *line_json(const struct recordings *r, size_t i) {
    const struct line *line = &r->lines[i];
    json_t *object = json_pack("{ss}", "engine", i == OTHER ? "another person" : r->variants[i].engine);
    if (i != OTHER)
        json_object_set_new(object, "contacts",
                            json_string(r->variants[i].contacts == CONTACTS_ON ? "on" : "off"));
    for (int m = 0; m < PERSON_MEASURES; m++) {
        if (!line->count[m])
            continue;
        json_t *one = json_object();
        for (int k = 0; k < 6; k++)
            json_object_set_new(one, figures[k], json_real(line->sum[m][k] / line->count[m]));
        json_object_set_new(object, person_measures[m], one);
    }
    json_object_set_new(object, "reader",
                        json_pack("{sI sI sI}", "right", (json_int_t)line->read.right, "read",
                                  (json_int_t)line->read.read, "usual", (json_int_t)line->read.usual));
    return object;
}

/* Prints the table or writes the JSON file. Returns an exit code. */
static int recordings_write(const struct recordings *r) {
    struct cli_file file;
    int status = EXIT_DONE;
    if (!r->options->json_path) {
        if (r->options->curves_path && !strcmp(r->options->curves_path, "-"))
            return EXIT_DONE;
        print(r, stdout);
        return fflush(stdout) ? EXIT_FAILED : EXIT_DONE;
    }
    json_t *rows = json_array();
    for (size_t i = 0; i < LINES; i++)
        if (label(r, i))
            json_array_append_new(rows, line_json(r, i));
    json_t *all = json_pack("{ss si sf so}", "lang", speech_pack_lang(r->pack), "recordings",
                            (int)r->options->people, "shift", r->options->shift * 1000, "rows", rows);
    int failed = cli_create(&file, r->options->json_path);
    if (!failed) {
        json_dumpf(all, file.file, JSON_INDENT(1) | JSON_REAL_PRECISION(7));
        fputc('\n', file.file);
    }
    if (failed || cli_finish(&file, true))
        status = EXIT_FAILED;
    json_decref(all);
    return status;
}

/* Bounds the time warp, which compares all pairs of phones. */
enum { MOST_PHONES = 5000 };

static int read_person(const char *curves, const char *phones, struct measured_speech *out) {
    struct error e = {0};
    char text[400];
    const char *path = curves;
    int result = fit_read_curves(curves, out, &e);
    if (!result) {
        path = phones;
        result = phone_times_read(phones, out, &e);
    }
    if (!result && out->phone_count > MOST_PHONES)
        result = error_set(&e, ERROR_BAD_CURVES, "more than %d phones", MOST_PHONES);
    double start, end;
    person_speech(out, &start, &end);
    if (!result && (out->times[0] > end || out->times[out->frame_count - 1] < start || end <= start))
        result = error_set(&e, ERROR_BAD_CURVES, "the curves do not cover the phones' time, %.3f to %.3f s",
                           start, end);
    if (result)
        cli_complain("%s: %s", path, error_text(&e, text, sizeof text));
    return result;
}

static int read_people(struct recordings *r) {
    const struct eval_options *o = r->options;
    for (size_t i = 0; i < o->people; i++)
        if (read_person(o->curves[i], o->phones[i], &r->people[i]) ||
            (o->other_curves[i] && read_person(o->other_curves[i], o->other_phones[i], &r->others[i])))
            return -1;
    for (int m = 0; m < PERSON_MEASURES; m++) {
        r->use[m] = true;
        for (size_t i = 0; i < o->people; i++)
            r->use[m] &=
                person_has(&r->people[i], m) && (!o->other_curves[i] || person_has(&r->others[i], m));
    }
    return 0;
}

static void note(struct line *line, int measure, const struct curve_match_shifted *m) {
    const double values[] = {m->as_is.correlation, m->as_is.offset_rms, m->as_is.affine_rms,
                             m->shift * 1000,      m->best.correlation, m->best.offset_rms};
    line->there = true;
    line->count[measure]++;
    for (int i = 0; i < 6; i++) /* a constant prediction correlates with nothing */
        line->sum[measure][i] += isnan(values[i]) && (i == 0 || i == 4) ? 0 : values[i];
}

static void sample(void *track, double t, struct fap_frame *frame) {
    face_track_sample(track, t, frame);
}

static double face_mm(void *ctx, int measure, double t) {
    struct person_face *face = ctx;
    face->measure = measure;
    return person_face_at(face, t);
}

static double person_mm(void *ctx, int measure, double t) {
    return person_at(ctx, measure, t);
}

static void add_person(const struct recordings *r, struct lip_reader *reader, int half,
                       struct measured_speech *person) {
    struct phone_segments g;
    measured_speech_segments(r->pack, person, NULL, NULL, &g);
    struct person_mouth mouth = {r->pack, &g, person_mm, person};
    person_reader_add(reader, half, &mouth, r->use);
    phone_segments_free(&g);
}

/* Adds a measure's frames to the table, without a measured value if the person's was not recorded. */
static void write_frames(const struct recordings *r, size_t recording, size_t line, int measure,
                         double (*predict)(void *ctx, double t), void *ctx, double always) {
    const struct measured_speech *person = &r->people[recording];
    double start, end;
    char measured[32] = "";
    person_speech(person, &start, &end);
    for (size_t i = 0; r->table.file && i < person->frame_count; i++) {
        double t = person->times[i];
        if (t < start || t > end)
            continue;
        const char *contacts = line == OTHER ? "" : r->variants[line].contacts == CONTACTS_ON ? "on" : "off";
        if (person_has(person, measure))
            snprintf(measured, sizeof measured, "%.4f", person_at(person, measure, t));
        fprintf(r->table.file, "%zu,%s,%s,%s,%.4f,%s,%.4f\n", recording + 1,
                line == OTHER ? "another person" : r->variants[line].engine, contacts,
                person_measures[measure], t, measured, predict(ctx, t - always));
    }
}

static void measure_engine(struct recordings *r, size_t variant, size_t recording) {
    const struct measured_speech *person = &r->people[recording];
    struct line *line = &r->lines[variant];
    struct sentence_audio *u = person_audio(person);
    struct face_options options = {
        .engine = r->variants[variant].engine, .still = true, .contacts = r->variants[variant].contacts};
    struct face_track *track = face_track_new(r->pack, u, &options, NULL, NULL);
    struct person_face face = {r->pack, {sample, track}, 0};
    for (face.measure = 0; face.measure < PERSON_MEASURES; face.measure++) {
        write_frames(r, recording, variant, face.measure, person_face_at, &face, r->options->shift);
        if (!person_has(person, face.measure))
            continue;
        struct curve_match_shifted m =
            person_match(person, face.measure, person_face_at, &face, r->options->shift);
        note(line, face.measure, &m);
    }
    struct phone_segments g;
    measured_speech_segments(r->pack, person, NULL, NULL, &g);
    struct person_mouth mouth = {r->pack, &g, face_mm, &face};
    person_reader_add(&line->reader, READER_READ, &mouth, r->use);
    phone_segments_free(&g);
    face_track_free(track);
    person_audio_free(u);
}

static int measure_other(struct recordings *r, size_t i) {
    struct person_warp warp;
    struct line *line = &r->lines[OTHER];
    person_warp_new(&warp, &r->people[i], &r->others[i]);
    size_t phones = 0;
    for (size_t k = 0; k < r->people[i].phone_count; k++)
        phones += r->people[i].phones[k].ipa[0] != '\0';
    bool same = 2 * warp.matched >= phones;
    if (!same)
        cli_complain("%s: the text differs from that of %s", r->options->other_phones[i],
                     r->options->phones[i]);
    for (warp.measure = 0; same && warp.measure < PERSON_MEASURES; warp.measure++) {
        if (!person_has(&r->people[i], warp.measure) || !person_has(&r->others[i], warp.measure))
            continue;
        struct curve_match_shifted m = person_match(&r->people[i], warp.measure, person_warp_at, &warp, 0);
        note(line, warp.measure, &m);
        write_frames(r, i, OTHER, warp.measure, person_warp_at, &warp, 0);
    }
    /* The lip reader learns from this speaker only, as the other may be among the recordings. */
    struct lip_reader reader = {0};
    add_person(r, &reader, READER_LEARN, &r->people[i]);
    add_person(r, &reader, READER_READ, &r->others[i]);
    struct lip_reader_result read = reader_run(&reader);
    line->read.read += read.read;
    line->read.right += read.right;
    line->read.usual += read.usual;
    lip_reader_free(&reader);
    person_warp_free(&warp);
    return same ? 0 : -1;
}

static int choose(struct recordings *r) {
    const struct eval_options *o = r->options;
    for (const char *const *engine = face_engines(); *engine; engine++) {
        bool speaks = face_engine_speaks(*engine, r->pack);
        if (!eval_options_name(o, *engine) || (!speaks && !o->engine_count))
            continue;
        if (!speaks) {
            cli_complain("engine: the engine '%s' does not speak '%s'", *engine, speech_pack_lang(r->pack));
            return EXIT_USAGE;
        }
        eval_options_variants(o, *engine, r->variants, &r->variant_count);
    }
    for (const char *const *engine = face_engine_ablations(); *engine; engine++)
        if (o->ablation || (o->engine_count && eval_options_name(o, *engine)))
            eval_options_variants(o, *engine, r->variants, &r->variant_count);
    return EXIT_DONE;
}

static int compare_engines(struct recordings *r, const struct speech_packs *packs) {
    const struct eval_options *o = r->options;
    const char *lang = o->request.lang ? o->request.lang : "it";
    r->pack = speech_packs_find(packs, lang);
    if (!r->pack) {
        cli_complain("lang: unknown language '%s'", lang);
        return EXIT_USAGE;
    }
    int status = choose(r);
    if (status || read_people(r))
        return status ? status : EXIT_FAILED;
    if (o->curves_path && cli_create(&r->table, o->curves_path))
        return EXIT_FAILED;
    if (r->table.file)
        fputs("recording,engine,contacts,parameter,time,measured,predicted\n", r->table.file);
    for (size_t i = 0; i < o->people; i++) {
        for (size_t v = 0; v < r->variant_count; v++)
            measure_engine(r, v, i);
        if (o->other_curves[i] && measure_other(r, i))
            return EXIT_FAILED;
    }
    for (size_t v = 0; v < r->variant_count; v++) {
        for (size_t i = 0; i < o->people; i++)
            add_person(r, &r->lines[v].reader, READER_LEARN, &r->people[i]);
        r->lines[v].read = reader_run(&r->lines[v].reader);
    }
    return recordings_write(r);
}

/* Returns an exit code. */
static int eval_recordings(const struct eval_options *o, const struct settings *settings) {
    struct recordings *r = mem_alloc(sizeof *r);
    struct components components;
    struct error e;
    char text[4200];
    int status = EXIT_FAILED;
    r->options = o;
    r->people = mem_alloc((o->people + 1) * sizeof *r->people);
    r->others = mem_alloc((o->people + 1) * sizeof *r->others);
    if (components_load(&components, settings, COMPONENTS_SPEECH, NULL, &e))
        cli_complain("%s", error_text(&e, text, sizeof text));
    else
        status = compare_engines(r, &components.packs);
    if (cli_finish(&r->table, status == EXIT_DONE) && status == EXIT_DONE)
        status = EXIT_FAILED;
    measured_speech_free_all(r->people, o->people);
    measured_speech_free_all(r->others, o->people);
    for (size_t i = 0; i < LINES; i++)
        lip_reader_free(&r->lines[i].reader);
    components_free(&components);
    free(r);
    return status;
}

/* faccia eval: renders the same speech at several rates with each engine, and measures the lips. */

struct run {
    struct cli cli;
    struct eval_options options;
    struct synthesis *synthesis;
    struct eval_report report;
    struct stretch_choice choice;
    size_t rate, segment; /* current ones */
    bool finished, failed;
};

static void measure(struct run *run, const struct media_segment *segment, size_t engine, bool chosen) {
    struct eval_report *r = &run->report;
    const struct speech_pack *pack =
        speech_packs_find(&run->cli.components.packs, synthesis_lang(run->synthesis));
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
    const struct speech_pack *pack =
        speech_packs_find(&run->cli.components.packs, synthesis_lang(run->synthesis));
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
    if (warning && run->rate) /* warnings are the same at every rate */
        return;
    cli_complain("%s%s", warning ? "warning: " : "", error_text(e, text, sizeof text));
    run->failed |= !warning;
}

static void on_finished(void *ctx, size_t spoken) {
    struct run *run = ctx;
    run->finished = true;
    run->failed |= !spoken;
}

/* Speaks the text at the current rate. */
static int speak(struct run *run) {
    static const struct synthesis_callbacks callbacks = {on_segment, on_problem, on_finished};
    struct error e;
    char message[400];
    run->options.request.rate = run->options.rates[run->rate];
    run->segment = 0;
    run->finished = false;
    run->synthesis =
        synthesis_open(&run->cli.components.pipeline, &run->options.request, &callbacks, run, &e);
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

/* Chooses the engines: those named, which must be able to speak the text, else all that can. */
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

/* Tells whether films are to be compared, which a Node.js program does with eval --recording. */
static bool has_film(int argc, char **argv) {
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (!strcmp(argv[i], "--film") || !strncmp(argv[i], "--film=", strlen("--film=")))
            return true;
    return false;
}

int eval_main(int argc, char **argv, const struct settings *settings) {
    if (has_film(argc, argv))
        return speaker_main(argc, argv, settings);
    struct run *run = mem_alloc(sizeof *run);
    struct buf text = {0};
    request_init(&run->options.request);
    int status = eval_options_parse(argc, argv, &run->options, &text);
    if (status < 0 && run->options.people) {
        status = eval_recordings(&run->options, settings);
    } else if (status < 0) {
        status = cli_open(&run->cli, settings) ? EXIT_FAILED : evaluate(run);
        cli_close(&run->cli);
    }
    request_free(&run->options.request);
    buf_free(&text);
    free(run);
    return status;
}
