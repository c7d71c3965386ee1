/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What faccia eval is asked for. */
#ifndef FACCIA_APP_EVAL_OPTIONS_H
#define FACCIA_APP_EVAL_OPTIONS_H

#include "server/app/eval_report.h"
#include "server/synthesis/speech_request.h"

enum { EVAL_RATES = 32, EVAL_PEOPLE = 64 };

struct eval_options {
    struct speech_request request;
    const char *json_path, *svg_path;
    double rates[EVAL_RATES]; /* rising */
    size_t rate_count;
    const char *engines[STRETCH_ENGINES];
    size_t engine_count; /* 0 = all that the language has */
    bool ablation, both; /* both: each engine with and without contacts */
    enum face_contacts contacts;
    /* people who were recorded: files of curves and of phones, and of others who say the same, or NULL */
    const char *curves[EVAL_PEOPLE], *phones[EVAL_PEOPLE], *other_curves[EVAL_PEOPLE],
        *other_phones[EVAL_PEOPLE];
    size_t people;
    double shift; /* s, of every prediction */
};

/* The exit code, after a message, or -1 to go on. The text, which recordings do not need, into *text. */
int eval_options_parse(int argc, char **argv, struct eval_options *o, struct buf *text);

/* Fills the variants of one engine that were asked for into list, which has room for STRETCH_ENGINES. */
void eval_options_variants(const struct eval_options *o, const char *engine, struct eval_variant *list,
                           size_t *count);

/* Whether the engine was named; all are where none was. */
bool eval_options_name(const struct eval_options *o, const char *engine);

#endif
