/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes an export in other threads, a piece at a time, so that the loop stays free for live listeners
 * live: coding a sentence's sound takes tens of milliseconds. What is added comes out in that order. */
#ifndef FACCIA_EXPORT_EXPORT_WORKER_H
#define FACCIA_EXPORT_EXPORT_WORKER_H

#include "server/export/export.h"

struct export_worker;

/* The source is copied. written: more lies in `out`, from whose head the receiver takes what it likes (of a
 * format that does not stream: only when all is done); `segments` more are used up; done: that was all.
 * Returns whether to go on at once; if not, export_worker_go_on does. Comes from the loop, never after
 * export_worker_free, which it may not call. */
struct export_worker *
export_worker_open(uv_loop_t *loop, const struct export_format *format, const struct export_source *source,
                   bool (*written)(void *ctx, struct buf *out, size_t segments, bool done), void *ctx);
void export_worker_add(struct export_worker *s, struct media_segment segment); /* which it owns then */
void export_worker_warn(struct export_worker *s, const struct error *warning);
void export_worker_end(struct export_worker *s); /* nothing more will be added */
void export_worker_go_on(struct export_worker *s);
void export_worker_free(struct export_worker *s);

#endif
