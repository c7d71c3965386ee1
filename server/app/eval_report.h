/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What faccia eval found, and its three forms. */
#ifndef FACCIA_APP_EVAL_REPORT_H
#define FACCIA_APP_EVAL_REPORT_H

#include "server/base/buf.h"
#include "server/eval/plot.h"
#include <stdio.h>

struct eval_report {
    const char *lang, *voice;
    double fps;
    const char *engines[STRETCH_ENGINES + 1];
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
