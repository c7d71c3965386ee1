/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What faccia eval found, and its three forms. */
#ifndef FACCIA_APP_EVAL_REPORT_H
#define FACCIA_APP_EVAL_REPORT_H

#include "server/base/buf.h"
#include "server/eval/plot.h"
#include "server/face/track.h"
#include <stdio.h>

/* An engine with or without the layer of contacts. */
struct eval_variant {
    const char *engine;
    enum face_contacts contacts; /* on or off */
    char label[48];              /* its name, and what is not as it has it */
};

struct eval_variant eval_variant(const char *engine, enum face_contacts contacts);

struct eval_report {
    const char *lang, *voice;
    double fps;
    struct eval_variant engines[STRETCH_ENGINES];
    size_t engine_count;
    double *rates; /* rising */
    size_t rate_count;
    struct eval *evals; /* [engine * rate_count + rate] */
    double (*values)[EVAL_MEASURES];
    struct stretch slow, fast;
};

void eval_report_table(const struct eval_report *r, FILE *file);
void eval_report_json(const struct eval_report *r, FILE *file);
void eval_report_svg(const struct eval_report *r, struct buf *out);

#endif
