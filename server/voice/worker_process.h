/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A worker process and the socket to it, on a libuv loop; or what stands for one that runs elsewhere
 * (far_process.h). It frees itself when it has been stopped and is gone. */
#ifndef FACCIA_VOICE_WORKER_PROCESS_H
#define FACCIA_VOICE_WORKER_PROCESS_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/voice/wire.h"
#include <uv.h>

struct process;

struct process_kind {
    void (*send)(struct process *p, struct buf *b);
    void (*stop)(struct process *p, bool politely);
};

/* The beginning of each. */
struct process {
    const struct process_kind *kind;
};

struct process_callbacks {
    void (*said)(void *ctx, const struct wire_frame *frame); /* may stop the process */
    void (*died)(void *ctx,
                 const char *how); /* "exited with status 1", "was killed by signal 11", "sent garbage" */
    void (*gone)(void *ctx);       /* the last call, after process_stop too */
};

/* The code of an error that passes: the system has no descriptors, memory or processes left. */
#define PROCESS_NO_ROOM ERROR_VOICE_UNAVAILABLE

/* Starts `program plugin`. NULL with *e; gone is called later all the same. The program must ignore SIGPIPE.
 */
struct process *process_start(uv_loop_t *loop, const char *program, const char *plugin,
                              const struct process_callbacks *callbacks, void *ctx, struct error *e);

/* Sends frames. Takes what is in b, which is empty afterwards. */
void process_send(struct process *p, struct buf *b);

/* Ends it: politely (it may finish, but not for long), or at once. Neither said nor died is called after
 * this. */
void process_stop(struct process *p, bool politely);

#endif
