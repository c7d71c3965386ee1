/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/cli.h"
#include "server/app/cli_file.h"
#include "server/app/eval_recordings_internal.h"
#include <jansson.h>

static const char *const figures[] = {"r", "rms", "affine_rms", "shift", "shifted_r", "shifted_rms"};

/* The name of a line, or NULL when there is nothing in it. */
static const char *label(const struct recordings *r, size_t line) {
    if (!r->lines[line].there)
        return NULL;
    return line == OTHER ? "another person" : r->variants[line].label;
}

static void print(const struct recordings *r, FILE *out) {
    static const int order[] = {PERSON_APERTURE, PARAM_LI, PARAM_LS, PARAM_AR, PARAM_PI,
                                PARAM_PS,        PARAM_EM, PARAM_TH, PARAM_TA, PARAM_TB};
    fprintf(out, "%zu recordings, %s, predictions %g ms later\n", r->options->people,
            speech_pack_lang(r->pack), r->options->shift * 1000);
    for (size_t k = 0; k < sizeof order / sizeof *order; k++) {
        int m = order[k];
        bool headed = false;
        for (size_t i = 0; i < LINES; i++) {
            const struct line *line = &r->lines[i];
            if (!label(r, i) || !line->count[m])
                continue;
            if (!headed)
                fprintf(out, "\n%-33s %6s %7s %7s   %6s %6s %7s\n", person_measures[m], "r", "rms", "affine",
                        "shift", "r", "rms");
            headed = true;
            double n = line->count[m];
            const double *s = line->sum[m];
            fprintf(out, "%-33s %6.2f %7.2f %7.2f   %6.0f %6.2f %7.2f\n", label(r, i), s[0] / n, s[1] / n,
                    s[2] / n, s[3] / n, s[4] / n, s[5] / n);
        }
    }
    fprintf(out, "\n%-33s %6s %7s %7s\n", "reader, taught by people", "right", "of", "usual");
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

int recordings_write(const struct recordings *r) {
    struct cli_file file;
    int status = EXIT_DONE;
    if (!r->options->json_path) {
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
