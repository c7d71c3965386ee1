/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a program once: never through a shell, in a process group of its own, within its time, and with what
 * it writes bounded. */
#ifndef FACCIA_PLUGINS_COMMAND_RUN_H
#define FACCIA_PLUGINS_COMMAND_RUN_H

#include "server/base/buf.h"
#include <stdatomic.h>
#include <stdbool.h>

/* Ends a run from another thread. */
struct cm_stop {
    int wake; /* eventfd */
    atomic_bool stopped;
};

int cm_stop_open(struct cm_stop *stop);
void cm_stop_close(struct cm_stop *stop);
void cm_stop_now(struct cm_stop *stop);
void cm_stop_reset(struct cm_stop *stop);

struct cm_run {
    char *const *argv; /* ends with NULL */
    const char *input; /* for its standard input; NULL = nothing */
    double seconds;
    size_t bytes; /* of its standard output, and of each file that it writes */
};

enum cm_result { CM_DONE, CM_STOPPED, CM_FAILED };

/* Standard output goes to *out. CM_FAILED with a sentence in message, which ends with the program's last
 * complaint. */
enum cm_result cm_run(const struct cm_run *run, struct cm_stop *stop, struct buf *out, char *message,
                      size_t cap);

#endif
