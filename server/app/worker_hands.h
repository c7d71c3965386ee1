/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Between the work queue and the voices: what faccia-worker offers, takes and gives back. */
#ifndef FACCIA_APP_WORKER_HANDS_H
#define FACCIA_APP_WORKER_HANDS_H

#include "server/cluster/work_queue.h"
#include "server/voice/voice_pool.h"

struct worker_hands;

extern const struct work_hands_events worker_hands_events;

/* The context of those events. */
struct worker_hands *worker_hands_new(void);
void worker_hands_free(struct worker_hands *w);

/* From then on there is something to offer. */
void worker_hands_begin(struct worker_hands *w, struct voice_pool *pool, struct work_hands *hands);

/* Nothing more is taken. */
void worker_hands_end(struct worker_hands *w);

/* How many sentences are being spoken. */
size_t worker_hands_busy(const struct worker_hands *w);

#endif
