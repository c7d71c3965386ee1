/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text spoken and written down in a format, while it is spoken: a request goes in, bytes come out. */
#ifndef FACCIA_EXPORT_SPEECH_EXPORT_H
#define FACCIA_EXPORT_SPEECH_EXPORT_H

#include "server/base/buf.h"
#include "server/export/export_format.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/speech_request.h"

struct speech_export;

/* From the loop, never from within speech_export_open. */
struct speech_export_callbacks {
    /* More lies in `out`, from whose head the receiver takes what it likes (of a format that does not stream:
     * only when all is done); done: that was all. Returns whether more may come; if not, no further sentence
     * is taken until speech_export_go_on. */
    bool (*written)(void *ctx, struct buf *out, bool done);
    /* Instead of all that: nothing could be spoken. */
    void (*failed)(void *ctx, const struct error *e);
};

/* warnings: what was found before, which the format may tell too; borrowed. NULL with *e as synthesis_open.
 */
struct speech_export *
speech_export_open(const struct pipeline *pipeline, const struct speech_request *request,
                   const struct export_format *format, const struct error *warnings, size_t warning_count,
                   const struct speech_export_callbacks *callbacks, void *ctx, struct error *e);
/* Of a request whose text is still being written: see synthesis_write, synthesis_close. */
int speech_export_write(struct speech_export *speech, const char *text, size_t size, size_t most,
                        struct error *e);
void speech_export_close(struct speech_export *speech);

void speech_export_go_on(struct speech_export *speech);
/* No callback comes after this; not from within one. NULL is ignored. */
void speech_export_free(struct speech_export *speech);

#endif
