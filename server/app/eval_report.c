/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/eval_report.h"
#include <jansson.h>
#include <math.h>

struct eval_variant eval_variant(const char *engine, enum face_contacts contacts) {
    bool own = face_engine_contacts(engine, CONTACTS_ENGINE), on = face_engine_contacts(engine, contacts);
    struct eval_variant v = {engine, on ? CONTACTS_ON : CONTACTS_OFF, ""};
    snprintf(v.label, sizeof v.label, "%s%s", engine, on == own ? "" : on ? " +contacts" : " -contacts");
    return v;
}

/* Words a minute that were really spoken, pauses included. */
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

void eval_report_table(const struct eval_report *r, FILE *file) {
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

void eval_report_json(const struct eval_report *r, FILE *file) {
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

void eval_report_svg(const struct eval_report *r, struct buf *out) {
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
