/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an utterance plays: a synthesis, a recording or a live voice, each behind this interface. It delivers
 * segments in order through its callbacks, only a few ahead of what has been released. */
#ifndef FACCIA_SYNTHESIS_SPEECH_SOURCE_H
#define FACCIA_SYNTHESIS_SPEECH_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct media_segment;
struct pipeline;
struct speech_request;
struct speech_source;
struct synthesis;

struct synthesis_callbacks {
    void (*segment)(void *ctx, struct media_segment segment);
    /* A sentence could not be spoken, or (warning) a part of the text was ignored. */
    void (*problem)(void *ctx, const struct error *e, bool warning);
    /* No segment follows; `spoken` segments came. */
    void (*finished)(void *ctx, size_t spoken);
};

/* Description for listeners; strings are borrowed from the source. */
struct source_description {
    const char *name;                           /* of a recording, else NULL */
    const char *voice, *lang, *engine, *markup; /* NULL = none */
    bool live;
    bool bell;          /* one sounds before it */
    unsigned lookahead; /* of a live voice, ms */
};

/* Callbacks may come within these. Those marked optional are NULL for a source that does not need them. */
struct speech_source_ops {
    void (*start)(struct speech_source *source);
    void (*release)(struct speech_source *source); /* one segment, so that another may come */
    void (*free)(struct speech_source *source);
    double (*fps)(const struct speech_source *source);     /* known from the first segment on */
    const char *(*id)(const struct speech_source *source); /* the client's, or NULL */
    void (*describe)(const struct speech_source *source, struct source_description *description);

    /* Optional, of a source that is still being written or heard. */
    bool (*is_open)(const struct speech_source *source);
    void (*close)(struct speech_source *source);
    bool (*awaits)(const struct speech_source *source);      /* more can come; what came was delivered */
    void (*wait)(struct speech_source *source, unsigned ms); /* delivers that much silence */
    /* ms for which what it awaits is late, not missing: no silence is inserted before that. Optional: 0. */
    unsigned (*grace)(const struct speech_source *source);

    /* Optional, of a live voice. */
    void (*write_sound)(struct speech_source *source, const uint8_t *bytes, size_t size);
    void (*catch_up)(struct speech_source *source); /* drops the backlog after a pause */
};

/* The first member of every source. */
struct speech_source {
    const struct speech_source_ops *ops;
    const struct speech_request *request; /* NULL = none, of a recording */
    struct synthesis *text;               /* the same source, if it speaks a text, else NULL */
    bool own_face;                        /* its frames are the whole face, the same each time it is played */
    bool one_face;                        /* the life beside its mouth continues across its segments */
};

/* Opens a source of one kind; `what` is its request. NULL with *e. */
typedef struct speech_source *speech_source_open(const struct pipeline *pipeline, void *what,
                                                 const struct synthesis_callbacks *callbacks, void *ctx,
                                                 struct error *e);

#endif
