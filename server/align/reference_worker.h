/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voice worker (faccia-voice) that a reference is spoken by, as a program without an event loop talks to
 * it: one question, then its answer. */
#ifndef FACCIA_ALIGN_REFERENCE_WORKER_H
#define FACCIA_ALIGN_REFERENCE_WORKER_H

#include "server/base/error.h"
#include "server/voice/wire.h"
#include <sys/types.h>

struct reference_worker {
    int fd;    /* -1 = there is none */
    pid_t pid; /* 0 = its parent is somebody else */
    struct buf in;
    size_t used; /* of in, by the last frame */
};

/* Starts `program plugin`; with an empty program asks for a worker on the descriptor that a plugin's worker
 * has for that (server/voice/wire.h). -1 with *e ("no-reference"). */
int reference_worker_start(struct reference_worker *w, const char *program, const char *plugin,
                           struct error *e);
/* It may end in peace, and is gone afterwards. */
void reference_worker_stop(struct reference_worker *w);

/* Sends a frame, made by wire_begin and wire_end; b is emptied. -1 with *e. */
int reference_worker_send(struct reference_worker *w, struct buf *b, struct error *e);

/* The next frame that is more than a sign of life; good until the next call. -1 with *e when it has ended,
 * sent garbage, or been silent for so many seconds. */
int reference_worker_hear(struct reference_worker *w, struct wire_frame *frame, double seconds,
                          struct error *e);

#endif
