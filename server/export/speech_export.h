/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The export formats, and the export of a text while it is spoken. */
#ifndef FACCIA_EXPORT_SPEECH_EXPORT_H
#define FACCIA_EXPORT_SPEECH_EXPORT_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/speech_request.h"
#include <stdbool.h>
#include <stdint.h>

struct export;
struct fap_frame;
struct media_segment;
struct score_part;
struct utf16_counter;

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
    /* Appends a part of a sentence's words, and what stands for it in the input. NULL = not reported. */
    void (*part)(struct buf *out, struct utf16_counter *utf16, const char *input, const char *words,
                 const struct score_part *part);
};

/* Ended by a NULL name. */
extern const struct export_format export_formats[];

const struct export_format *export_by_name(const char *name);

/* Speaks a text and exports it at the same time. */

struct speech_export;

/* Called from the loop, never within speech_export_open. */
struct speech_export_callbacks {
    /* Output is available; the receiver consumes it from the front (for a format that does not stream,
     * only at the end). done: it is complete. Returns whether to continue; if not, speech_export_go_on
     * must be called. */
    bool (*written)(void *ctx, struct buf *out, bool done);
    /* Called instead of `written` if nothing could be spoken. */
    void (*failed)(void *ctx, const struct error *e);
};

/* warnings: found earlier, for formats that report them; borrowed. Returns NULL with *e like
 * synthesis_open. */
struct speech_export *
speech_export_open(const struct pipeline *pipeline, const struct speech_request *request,
                   const struct export_format *format, const struct error *warnings, size_t warning_count,
                   const struct speech_export_callbacks *callbacks, void *ctx, struct error *e);
/* For open texts: see synthesis_write, synthesis_close. */
int speech_export_write(struct speech_export *speech, const char *text, size_t size, size_t most,
                        struct error *e);
void speech_export_close(struct speech_export *speech);

void speech_export_go_on(struct speech_export *speech);
/* No callback follows; must not be called from one. Accepts NULL. */
void speech_export_free(struct speech_export *speech);

#endif
