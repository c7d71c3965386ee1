/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands for a worker process while the process runs on another machine: it says what such a process
 * would say, and gives its sentences to the work queue of the cluster. Only DONE is otherwise: its number is
 * an enum error_code, or 0, and its text all that is to be said. */
#ifndef FACCIA_VOICE_FAR_PROCESS_H
#define FACCIA_VOICE_FAR_PROCESS_H

#include "server/cluster/work_queue.h"
#include "server/voice/voice_pool.h"
#include "server/voice/worker_process.h"

/* description is what HELLO says; queue and description are borrowed until it is gone. */
struct process *far_process_start(uv_loop_t *loop, struct work *work, const char *queue,
                                  const char *description, const struct process_callbacks *callbacks,
                                  void *ctx);

/* Whose turn the next sentence is, and whose it is. */
void far_process_turn(struct process *p, enum voice_turn turn, uint32_t payer);

#endif
