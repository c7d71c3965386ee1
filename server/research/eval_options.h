/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of faccia eval, and its report in three formats. */
#ifndef FACCIA_RESEARCH_EVAL_OPTIONS_H
#define FACCIA_RESEARCH_EVAL_OPTIONS_H

#include "server/base/buf.h"
#include "server/face/track.h"
#include "server/research/plot.h"
#include "server/synthesis/speech_request.h"
#include <stdio.h>

/* An engine with or without the contact layer. */
struct eval_variant {
    const char *engine;
    enum face_contacts contacts; /* on or off */
    char label[48];              /* its name, and how it differs from the engine's default */
};

struct eval_variant eval_variant(const char *engine, enum face_contacts contacts);

struct eval_report {
    const char *lang, *voice;
    double fps;
    struct eval_variant engines[STRETCH_ENGINES];
    size_t engine_count;
    double *rates; /* ascending */
    size_t rate_count;
    struct eval *evals; /* [engine * rate_count + rate] */
    double (*values)[EVAL_MEASURES];
    struct stretch slow, fast;
};

/* ---- options ---- */

enum { EVAL_RATES = 32, EVAL_PEOPLE = 64 };

struct eval_options {
    struct speech_request request;
    const char *json_path, *svg_path, *curves_path;
    double rates[EVAL_RATES]; /* ascending */
    size_t rate_count;
    const char *engines[STRETCH_ENGINES];
    size_t engine_count; /* 0 = all engines of the language */
    bool ablation, both; /* both: each engine with and without contacts */
    enum face_contacts contacts;
    /* recorded speakers: files of curves and phones, and of another speaker of the same words, or NULL */
    const char *curves[EVAL_PEOPLE], *phones[EVAL_PEOPLE], *other_curves[EVAL_PEOPLE],
        *other_phones[EVAL_PEOPLE];
    size_t people;
    double shift; /* s, added to the time of every prediction */
};

/* Returns an exit code after a message, or -1 to continue. Recordings need no *text. */
int eval_options_parse(int argc, char **argv, struct eval_options *o, struct buf *text);

/* Lists the requested variants of an engine; the list has room for STRETCH_ENGINES. */
void eval_options_variants(const struct eval_options *o, const char *engine, struct eval_variant *list,
                           size_t *count);

/* True when the engine was named, or none was. */
bool eval_options_name(const struct eval_options *o, const char *engine);

#endif
