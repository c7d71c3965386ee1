/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences that were asked for: into the queue, and what comes of them. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_work_internal.h"
#include "server/cluster/redis_work_scripts.h"
#include <stdio.h>
#include <stdlib.h>
#include <utlist.h>

static const char *const why[WORK_ENDS] = {
    [WORK_UNREACHED] = "cannot be asked: its workers cannot be reached",
    [WORK_FULL] = "cannot be asked: its queue is full",
    [WORK_FAILED] = "has lost the sentence on its way",
};

static void end_task(struct redis_task *t, enum work_end end, const struct buf *body) {
    struct redis_work *w = (struct redis_work *)t->task.work;
    DL_DELETE(w->tasks, t);
    if (t->answered)
        t->answered(t->ctx, end, body);
    buf_free(&t->body);
    free(t);
}

static void fail_task(struct redis_task *t, enum work_end end) {
    const struct buf body = {(uint8_t *)why[end], strlen(why[end]), 0};
    end_task(t, end, &body);
}

static void drop(struct redis_work *w, const char *name) {
    const char *space = strchr(name, ' ');
    if (space)
        redis_work_run(w->mouth, SCRIPT_WORK_DROP,
                       (struct link_text[]){{name, (size_t)(space - name)}, link_text_of(space + 1)}, 2, NULL,
                       NULL);
}

/* What failed where nobody may be called. A callback may put the next one, which has its turn later. */
void redis_tasks_on_soon(uv_timer_t *timer) {
    struct redis_work *w = timer->data;
    struct redis_task *due = NULL, *t, *next;
    DL_FOREACH_SAFE(w->tasks, t, next)
    if (t->failed) {
        due = t;
        break;
    }
    if (!due)
        return;
    uv_timer_start(&w->soon, redis_tasks_on_soon, 0, 0);
    fail_task(due, due->failed);
}

static void fail_soon(struct redis_task *t, enum work_end end) {
    struct redis_work *w = (struct redis_work *)t->task.work;
    t->failed = end;
    if (!w->closed)
        uv_timer_start(&w->soon, redis_tasks_on_soon, 0, 0);
}

static void on_put(void *ctx, const redisReply *reply) {
    struct redis_task *t = ctx;
    struct redis_work *w = (struct redis_work *)t->task.work;
    bool full = reply && reply->type == REDIS_REPLY_INTEGER,
         well = reply && reply->type == REDIS_REPLY_STRING && (size_t)reply->len < sizeof t->name;
    if (!full && !well)
        redis_work_well(reply);
    if (!t->answered) {
        if (well)
            drop(w, reply->str);
        free(t); /* it has left the list */
    } else if (well) {
        memcpy(t->name, reply->str, (size_t)reply->len + 1);
    } else {
        fail_soon(t, full ? WORK_FULL : WORK_UNREACHED);
    }
}

struct work_task *redis_task_put(struct work *work, const char *queue, enum work_turn turn, uint32_t payer,
                                 const struct buf *sentence, work_answered answered, void *ctx) {
    struct redis_work *w = (struct redis_work *)work;
    struct redis_task *t = mem_alloc(sizeof *t);
    struct buf packed = {0};
    char number[NUMBER_BYTES], lane[NUMBER_BYTES];
    t->task.work = work;
    t->answered = answered;
    t->ctx = ctx;
    DL_APPEND(w->tasks, t);
    work_pack_sentence(sentence, &packed);
    snprintf(number, sizeof number, "%d", turn);
    snprintf(lane, sizeof lane, "%u", (payer ? payer : w->lane) % (unsigned)atoi(REDIS_WORK_LANES));
    const struct link_text more[] = {link_text_of(queue),        link_text_of(number), link_text_of(lane),
                                     {packed.data, packed.size}, link_text_of(w->to),  link_text_of(w->most)};
    if (!redis_work_run(w->mouth, SCRIPT_WORK_PUT, more, 6, on_put, t))
        fail_soon(t, WORK_UNREACHED);
    buf_free(&packed);
    return &t->task;
}

void redis_task_cancel(struct work_task *task) {
    struct redis_task *t = (struct redis_task *)task;
    struct redis_work *w = (struct redis_work *)task->work;
    DL_DELETE(w->tasks, t);
    t->answered = NULL;
    buf_free(&t->body);
    if (!*t->name && !t->failed)
        return; /* on_put will know its name */
    drop(w, t->name);
    free(t);
}

static struct redis_task *task_by_name(struct redis_work *w, const char *name) {
    struct redis_task *t;
    DL_FOREACH(w->tasks, t)
    if (*t->name && !strcmp(t->name, name))
        return t;
    return NULL;
}

bool redis_task_piece(struct redis_work *w, const void *data, size_t size) {
    struct work_piece piece;
    if (!work_unpack_piece(data, size, &piece)) {
        log_warn("cluster: an answer that is none was left out");
        return false;
    }
    struct redis_task *t = task_by_name(w, piece.task);
    if (!t || t->failed)
        return true; /* it was cancelled */
    if (piece.index == 0) {
        memcpy(t->attempt, piece.attempt, sizeof t->attempt);
        t->body.size = t->pieces = 0;
    }
    if (strcmp(t->attempt, piece.attempt) != 0 || piece.index != t->pieces ||
        t->body.size + piece.size > WORK_BODY_MOST)
        return true; /* of a worker that had lost it; what is missing is missed (on_looked) */
    t->pieces++;
    t->missed = 0;
    buf_add(&t->body, piece.body, piece.size);
    if (piece.last)
        end_task(t, piece.end, &t->body);
    return true;
}

/* It was not there twice: its answer has been under way for long enough. */
void redis_tasks_miss(struct redis_work *w, const redisReply *gone) {
    for (size_t i = 0; gone->type == REDIS_REPLY_ARRAY && i < gone->elements; i++) {
        struct redis_task *t = task_by_name(w, redis_work_text(gone, i));
        if (t && !t->failed && ++t->missed > 1)
            fail_soon(t, WORK_FAILED);
    }
}

void redis_tasks_fail(struct redis_work *w) {
    struct redis_task *t;
    DL_FOREACH(w->tasks, t)
    if (*t->name && !t->failed)
        fail_soon(t, WORK_UNREACHED);
}
