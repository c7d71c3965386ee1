/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/eval_recordings.h"
#include "server/app/cli.h"
#include "server/app/eval_recordings_internal.h"
#include "server/app/fit_read.h"
#include "server/app/phone_times.h"
#include "server/app/stages.h"
#include "server/base/mem.h"
#include "server/face/packs/speech_pack.h"
#include <math.h>
#include <stdlib.h>

/* The time warp looks at all pairs of phones. */
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
        result = error_set(&e, ERROR_BAD_CURVES,
                           "the curves are not those of the phones' time, %.3f to %.3f s", start, end);
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
    for (int i = 0; i < 6; i++) /* a prediction that stands still correlates with nothing */
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

static void measure_engine(struct recordings *r, size_t variant, const struct measured_speech *person) {
    struct line *line = &r->lines[variant];
    struct sentence_audio *u = person_audio(person);
    struct face_options options = {
        .engine = r->variants[variant].engine, .still = true, .contacts = r->variants[variant].contacts};
    struct face_track *track = face_track_new(r->pack, u, &options, NULL, NULL);
    struct person_face face = {r->pack, {sample, track}, 0};
    for (face.measure = 0; face.measure < PERSON_MEASURES; face.measure++) {
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
        cli_complain("%s: does not say the same as %s", r->options->other_phones[i], r->options->phones[i]);
    for (warp.measure = 0; same && warp.measure < PERSON_MEASURES; warp.measure++) {
        if (!person_has(&r->people[i], warp.measure) || !person_has(&r->others[i], warp.measure))
            continue;
        struct curve_match_shifted m = person_match(&r->people[i], warp.measure, person_warp_at, &warp, 0);
        note(line, warp.measure, &m);
    }
    /* Taught by the one person alone: the other one may be among the recordings. */
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

static int run(struct recordings *r, const struct speech_packs *packs) {
    const struct eval_options *o = r->options;
    const char *lang = o->request.lang ? o->request.lang : "it";
    r->pack = speech_packs_find(packs, lang);
    if (!r->pack) {
        cli_complain("lang: no language '%s'", lang);
        return EXIT_USAGE;
    }
    int status = choose(r);
    if (status || read_people(r))
        return status ? status : EXIT_FAILED;
    for (size_t i = 0; i < o->people; i++) {
        for (size_t v = 0; v < r->variant_count; v++)
            measure_engine(r, v, &r->people[i]);
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

int eval_recordings(const struct eval_options *o, const struct settings *settings) {
    struct recordings *r = mem_alloc(sizeof *r);
    struct stages stages;
    struct error e;
    char text[4200];
    int status = EXIT_FAILED;
    r->options = o;
    r->people = mem_alloc((o->people + 1) * sizeof *r->people);
    r->others = mem_alloc((o->people + 1) * sizeof *r->others);
    if (stages_load(&stages, settings, STAGES_SPEECH, NULL, &e))
        cli_complain("%s", error_text(&e, text, sizeof text));
    else
        status = run(r, &stages.packs);
    measured_speech_free_all(r->people, o->people);
    measured_speech_free_all(r->others, o->people);
    for (size_t i = 0; i < LINES; i++)
        lip_reader_free(&r->lines[i].reader);
    stages_free(&stages);
    free(r);
    return status;
}
