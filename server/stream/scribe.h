/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes an export in other threads, a piece at a time, so that the loop stays free for those who listen
 * live: coding a sentence's sound takes tens of milliseconds. What is added comes out in that order. */
#ifndef FACCIA_STREAM_SCRIBE_H
#define FACCIA_STREAM_SCRIBE_H

#include "server/stream/export.h"

struct scribe;

/* The source is copied. written: more lies in `out`, from whose head the receiver takes what it likes (of a
 * format that does not stream: only when all is done); `scenes` more are used up; done: that was all. Returns
 * whether to go on at once; if not, scribe_go_on does. Comes from the loop, never after scribe_free, which it
 * may not call. */
struct scribe *scribe_open(uv_loop_t *loop, const struct export_format *format,
                           const struct export_source *source,
                           bool (*written)(void *ctx, struct buf *out, size_t scenes, bool done), void *ctx);
void scribe_add(struct scribe *s, struct scene scene); /* which it owns then */
void scribe_warn(struct scribe *s, const struct error *warning);
void scribe_end(struct scribe *s); /* nothing more will be added */
void scribe_go_on(struct scribe *s);
void scribe_free(struct scribe *s);

#endif
