/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A session's events for analysis. */
#ifndef FACCIA_ROOMS_SESSION_EXPORT_H
#define FACCIA_ROOMS_SESSION_EXPORT_H

#include "server/base/buf.h"
#include <jansson.h>

/* A Praat TextGrid: what was heard from listeners, what the face said, by sentences and words, and points for
 * the other events. seconds: its length. */
void session_grid(struct buf *out, const json_t *events, double seconds);

/* A table (RFC 4180) of all events but previews: time, type, text, by, id. */
void session_table(struct buf *out, const json_t *events);

#endif
