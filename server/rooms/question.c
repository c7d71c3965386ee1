/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/rooms/question.h"
#include "server/base/mem.h"
#include "server/rooms/notices.h"
#include "server/rooms/rooms_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { QUESTION_BYTES = 1000 };

struct question {
    struct channel *channel;
    char *id, *text;
    uint32_t utterance;
    unsigned seconds;
    bool choices; /* offered by it */
    bool spoken;
    uv_timer_t *timer;
    struct question_watch *watch; /* NULL: nobody waits */
};

int question_check(const json_t *message, struct error *e) {
    const json_t *choices = json_object_get(message, "choices");
    return choices ? notice_check_choices(choices, e) : 0;
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

static void question_free(struct question *q) {
    uv_close((uv_handle_t *)q->timer, free_timer);
    free(q->id);
    free(q->text);
    free(q);
}

/* Offers the choices of the message; without a message, withdraws them. */
static void offer(const struct question *q, const json_t *message) {
    struct error ignored;
    json_t *told = json_pack("{ss ss}", "id", q->id, "question", q->text);
    const json_t *choices = json_object_get(message, "choices");
    json_object_set_new(told, "choices", choices ? json_incref((json_t *)choices) : json_array());
    notice_choices(q->channel, told, &ignored);
    json_decref(told);
}

/* Ends the channel's question. more: further members of `answered`, released; NULL: none. */
static void finish(struct channel *c, const char *reason, json_t *more) {
    struct question *q = c->question;
    json_t *told =
        json_pack("{ss ss ss ss}", "type", "answered", "stream", c->name, "id", q->id, "reason", reason);
    const bool offered = q->choices && !strcmp(reason, "timeout");
    if (more)
        json_object_update(told, more);
    json_decref(more);
    c->question = NULL;
    if (offered)
        offer(q, NULL);
    if (q->watch) {
        q->watch->question = NULL;
        q->watch->answered(q->watch->ctx, told);
    }
    question_free(q);
    queued_message_release(notice_tell(c, told, ANSWERED));
    json_decref(told);
}

/* The beginning of the text, as long as a question may be. */
static char *cut(const char *text) {
    size_t size = strlen(text);
    if (size > QUESTION_BYTES)
        for (size = QUESTION_BYTES; size && ((unsigned char)text[size] & 0xC0) == 0x80; size--)
            ;
    return mem_strndup(text, size);
}

static void on_time(uv_timer_t *timer) {
    const struct question *q = timer->data;
    finish(q->channel, "timeout", NULL);
}

void question_begin(struct channel *c, const json_t *message, uint32_t utterance) {
    const char *id = json_string_value(json_object_get(message, "id"));
    const char *text = json_string_value(json_object_get(message, "text"));
    const json_t *seconds = json_object_get(message, "seconds");
    char own[32];
    if (c->question)
        finish(c, "withdrawn", NULL);
    snprintf(own, sizeof own, "ask-%u", utterance);
    struct question *q = mem_alloc(sizeof *q);
    *q = (struct question){.channel = c,
                           .id = mem_strdup(id ? id : own),
                           .text = cut(text ? text : ""),
                           .utterance = utterance,
                           .seconds = seconds ? (unsigned)json_number_value(seconds) : QUESTION_SECONDS,
                           .choices = json_array_size(json_object_get(message, "choices"))};
    q->timer = mem_alloc(sizeof *q->timer);
    uv_timer_init(c->rooms->pipeline->loop, q->timer);
    q->timer->data = q;
    if (q->choices)
        offer(q, message);
    c->question = q;
}

void question_repeated(struct channel *c, uint32_t before, uint32_t utterance) {
    struct question *q = c->question;
    if (!q || q->utterance != before)
        return;
    q->utterance = utterance;
    q->spoken = false;
    uv_timer_stop(q->timer);
}

bool question_watch_begin(struct question_watch *watch, struct channel *c) {
    watch->question = c->question;
    if (c->question)
        c->question->watch = watch;
    return c->question;
}

void question_watch_end(struct question_watch *watch) {
    if (watch->question)
        watch->question->watch = NULL;
    watch->question = NULL;
}

/* One that was cut short waits, too: its listener may have begun to answer. */
void question_spoken(struct channel *c, uint32_t utterance, const char *reason) {
    struct question *q = c->question;
    if (!q || q->utterance != utterance || q->spoken)
        return;
    q->spoken = true;
    if (!reason || !strcmp(reason, "failed")) {
        finish(c, "failed", NULL);
        return;
    }
    uv_timer_start(q->timer, on_time, (uint64_t)q->seconds * 1000, 0);
    json_t *told = json_pack("{ss ss ss ss si}", "type", "asked", "stream", c->name, "id", q->id, "question",
                             q->text, "seconds", (int)q->seconds);
    queued_message_release(notice_tell(c, told, "asked"));
    json_decref(told);
}

void question_chosen(struct channel *c, const json_t *chosen) {
    const char *id = json_string_value(json_object_get(chosen, "id"));
    if (!c->question || !c->question->choices || !id || strcmp(id, c->question->id) != 0)
        return;
    finish(c, "chosen",
           json_pack("{sO sO sO}", "text", json_object_get(chosen, "text"), "choice",
                     json_object_get(chosen, "choice"), "by", json_object_get(chosen, "by")));
}

void question_offered(struct channel *c) {
    if (c->question && c->question->choices)
        finish(c, "withdrawn", NULL);
}

void question_heard(struct channel *c, const char *text, const char *by) {
    if (c->question && !c->question->choices && *text)
        finish(c, "heard", json_pack("{ss ss}", "text", text, "by", by));
}

void question_drop(struct channel *c) {
    if (!c->question)
        return;
    struct question *q = c->question;
    c->question = NULL;
    if (q->watch) {
        json_t *told = json_pack("{ss ss ss ss}", "type", "answered", "stream", c->name, "id", q->id,
                                 "reason", "failed");
        q->watch->question = NULL;
        q->watch->answered(q->watch->ctx, told);
        json_decref(told);
    }
    question_free(q);
}
