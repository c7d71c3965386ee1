/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A section of a work, spoken: which stretches of its blocks are heard when. The sound, and the face that
 * goes with it, are handed on sentence by sentence and not kept. */
#ifndef FACCIA_PUBLISH_RECITAL_H
#define FACCIA_PUBLISH_RECITAL_H

#include "server/library/work.h"
#include "server/synthesis/synthesis.h"

/* What is marked as one while it is heard: a word, or a sentence as far as it lies in one line of verse. */
struct recital_unit {
    size_t block;    /* of the section */
    size_t from, to; /* bytes of the block's text */
    uint64_t start;  /* samples from the section's beginning; never less than the one before */
};

/* Of one section. Zeroed: nothing was spoken. */
struct recital_part {
    struct recital_unit *units;
    size_t count, cap;
    uint64_t samples;
};

struct recital {
    const struct pipeline *pipeline;
    struct speech_request *request; /* voice: of what is in `lang`; borrowed */
    const char *lang;               /* of the work */
    bool any_lang;                  /* the voice speaks all of it: a recording */
    bool sentences;                 /* units are those, not words */
    /* A sentence, whose start counts from the beginning of the work. text, markup: what its bytes are places
     * in. All segments have the same rate. Not 0: no more is wanted. */
    int (*segment)(void *ctx, const struct media_segment *segment, const char *text, const char *markup);
    void (*problem)(void *ctx, const struct error *e, bool warning);
    void *ctx;
    uint32_t rate;    /* Hz; 0 = nothing was spoken yet */
    uint64_t samples; /* so far, of the work */
    char voice[80];   /* the first that spoke */
    bool stopped;
};

enum { RECITAL_RATE_MAX = 48000 }; /* Hz: a voice of a higher rate is converted */

/* Speaks what can be read of the section: heads, paragraphs, verses. Runs the pipeline's loop until it is
 * done. A passage that cannot be spoken is a problem, and the rest goes on. */
void recital_section(struct recital *recital, const struct section *section, struct recital_part *part);
void recital_part_free(struct recital_part *part);

#endif
