/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/work_queue.h"
#include <stddef.h>

void work_watch(struct work *work, work_seen seen, void *ctx) {
    work->engine->watch(work, seen, ctx);
}

struct work_task *work_put(struct work *work, const char *queue, enum work_turn turn, uint32_t payer,
                           const struct buf *sentence, work_answered answered, void *ctx) {
    return work->engine->put(work, queue, turn, payer, sentence, answered, ctx);
}

void work_cancel(struct work_task *task) {
    if (task)
        task->work->engine->cancel(task);
}

void work_close(struct work *work) {
    if (work)
        work->engine->close(work);
}

void work_hands_look(struct work_hands *hands) {
    hands->engine->look(hands);
}

void work_answer(struct work_item *item, enum work_end end, const struct buf *body) {
    item->hands->engine->answer(item, end, body);
}

void work_give_back(struct work_item *item) {
    item->hands->engine->give_back(item);
}

void work_hands_close(struct work_hands *hands) {
    if (hands)
        hands->engine->close(hands);
}
