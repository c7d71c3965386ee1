/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the coach. */
#ifndef FACCIA_COACH_COACH_INTERNAL_H
#define FACCIA_COACH_COACH_INTERNAL_H

#include "server/coach/judge.h"
#include <jansson.h>

struct synthesis;

struct coach_model {
    struct synthesis *synthesis;
    struct reference_speech speech;
    unsigned seconds;                                    /* longest */
    void (*done)(void *ctx, const struct error *failed); /* NULL: it has been called */
    void *ctx;
    struct error problem;         /* the last one of the voice; ERROR_NONE: none */
    char lang[16], *voice, *text; /* once it is complete */
    size_t text_size;
};

/* The comparison as JSON. */
json_t *coach_json(const struct coach_model *model, const struct judgement *judgement);

#endif
