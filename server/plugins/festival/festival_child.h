/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Festival process: requests go to its standard input, answers come on descriptor 3, messages on
 * standard error. All waits can be cancelled from another thread. */
#ifndef FACCIA_PLUGINS_FESTIVAL_FESTIVAL_CHILD_H
#define FACCIA_PLUGINS_FESTIVAL_FESTIVAL_CHILD_H

#include "server/base/buf.h"
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/types.h>

struct fe_child {
    const char *program, *script;
    pid_t pid; /* 0 = none */
    int in, out, complaints;
    struct buf answer;   /* data read */
    size_t taken;        /* bytes consumed */
    char complaint[200]; /* last line of its messages */
    int wake;            /* eventfd, written by fe_child_cancel */
    atomic_bool cancelled;
};

enum fe_result { FE_OK, FE_CANCELLED, FE_DIED };

int fe_child_open(struct fe_child *child, const char *program, const char *script);
void fe_child_close(struct fe_child *child);

/* Starts the process if none runs; returns false with errno on failure. */
bool fe_child_start(struct fe_child *child);

/* Sends a request. */
enum fe_result fe_child_send(struct fe_child *child, const struct buf *request);

/* Read the answer's next line without its end, or its next size bytes; valid until the next call. */
enum fe_result fe_child_line(struct fe_child *child, const char **line);
enum fe_result fe_child_bytes(struct fe_child *child, size_t size, const void **bytes);

/* Ends the process and describes how it had ended, or "". */
void fe_child_kill(struct fe_child *child, char *how, size_t cap);

/* From any thread: makes waits return FE_CANCELLED until fe_child_begin. */
void fe_child_cancel(struct fe_child *child);
void fe_child_begin(struct fe_child *child);

#endif
