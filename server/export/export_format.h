/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The export formats. */
#ifndef FACCIA_EXPORT_EXPORT_FORMAT_H
#define FACCIA_EXPORT_EXPORT_FORMAT_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stdint.h>

struct export;
struct fap_frame;
struct media_segment;

struct export_format {
    const char *name; /* "wav" */
    const char *content_type;
    /* Output is available while speaking; otherwise only at the end. */
    bool streams;
    /* Writes the segment's samples from x->at up to `to`. */
    void (*piece)(struct export *x, const struct media_segment *segment, uint32_t to);
    void (*end)(struct export *x);
    void (*warning)(struct export *x, const struct error *e); /* NULL = not reported */
    void (*free)(struct export *x);                           /* frees its coder; NULL = none */
    /* NDJSON: writes a frame's member with a leading comma; in a speech, phones are written as visemes. */
    void (*member)(struct export *x, const struct fap_frame *frame);
    bool visemes;
};

/* Ended by a NULL name. */
extern const struct export_format export_formats[];
const struct export_format *export_by_name(const char *name);

#endif
