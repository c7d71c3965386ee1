/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Standard input, spoken while it is written. */
#ifndef FACCIA_APP_CLI_WRITTEN_H
#define FACCIA_APP_CLI_WRITTEN_H

#include "server/synthesis/synthesis.h"

struct cli_written {
    uv_poll_t poll;
    struct synthesis *synthesis; /* NULL: it has been released, or was never begun */
    bool watches, failed;        /* failed: after a message */
};

/* Hands on to the synthesis, which is open, what comes from then on, and closes it at the end. */
void cli_written_begin(struct cli_written *written, uv_loop_t *loop, struct synthesis *synthesis);

/* Before the synthesis goes. The loop has to run once more. */
void cli_written_end(struct cli_written *written);

#endif
