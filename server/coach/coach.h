/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pronunciation coach: a voice speaks the text as a model, and a learner's recording of the same text is
 * compared with it (judge.h). Nothing is stored. */
#ifndef FACCIA_COACH_COACH_H
#define FACCIA_COACH_COACH_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdatomic.h>
#include <stddef.h>

struct lip_network;
struct pipeline;
struct reader;
struct speech_request;

/* The text, as a voice speaks it. */
struct coach_model;

/* Speaks the text of the request. done(ctx, failed): from the loop, once; failed NULL: the model is complete.
 * seconds: longest model. NULL with *e as synthesis_open. */
struct coach_model *coach_model_new(const struct pipeline *pipeline, const struct speech_request *request,
                                    unsigned seconds, void (*done)(void *ctx, const struct error *failed),
                                    void *ctx, struct error *e);
void coach_model_free(struct coach_model *model); /* also before it is done; NULL is ignored */

struct coach_options {
    const struct lip_network *network; /* borrowed */
    const struct reader *reader;       /* decodes the recording; NULL: in this process */
    unsigned seconds;                  /* longest recording */
    const atomic_bool *given_up;       /* see judge(); may be NULL */
};

/* Compares the recording open as `fd`, which it closes, with a complete model. Blocks for about a tenth of
 * the recording's duration; any thread may call it. Returns the comparison as JSON (protocol/README.md,
 * "Coach"), or NULL with *e: "bad-sound", "misaligned", "media-too-large", "cancelled". */
json_t *coach_compare(const struct coach_model *model, int fd, const struct coach_options *options,
                      struct error *e);

#endif
