/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/far_process.h"
#include "server/base/mem.h"
#include <stdlib.h>

struct far_process {
    struct process process;
    struct work *work;
    const char *queue, *description;
    uv_timer_t pulse;
    bool greeted, stopped;
    enum work_turn turn;
    uint32_t payer;
    uint32_t job;           /* that it speaks; 0 = none */
    struct work_task *task; /* NULL: what it asked for has been answered */
    struct process_callbacks callbacks;
    void *ctx;
};

static void say(struct far_process *p, enum wire_type type, const struct buf *payload) {
    const struct wire_frame frame = {type, p->job, payload ? payload->data : (const uint8_t *)"",
                                     payload ? payload->size : 0};
    if (!p->stopped)
        p->callbacks.said(p->ctx, &frame);
}

static void say_done(struct far_process *p, enum error_code code, const char *text) {
    struct buf payload = {0};
    wire_put_u32(&payload, code);
    wire_put_string(&payload, text);
    uv_timer_stop(&p->pulse);
    say(p, WIRE_DONE, &payload);
    buf_free(&payload);
}

static void on_pulse(uv_timer_t *timer) {
    struct far_process *p = timer->data;
    struct buf payload = {0};
    if (p->greeted) {
        say(p, p->task ? WIRE_WAITING : WIRE_ALIVE, NULL);
        return;
    }
    p->greeted = true;
    uv_timer_stop(timer);
    wire_put_string(&payload, p->description);
    say(p, WIRE_HELLO, &payload);
    buf_free(&payload);
}

static void die(struct far_process *p, const char *how) {
    bool tell = !p->stopped;
    p->stopped = true;
    if (tell)
        p->callbacks.died(p->ctx, how);
    if (!uv_is_closing((uv_handle_t *)&p->pulse))
        process_stop(&p->process, false);
}

/* All that the voice said, at once. It may be stopped by any of it. */
static void say_again(struct far_process *p, const struct buf *body) {
    struct wire_frame frame;
    size_t at = 0, used = 0;
    uint32_t job = p->job;
    while (!p->stopped && p->job == job && at < body->size) {
        if (wire_next(body->data + at, body->size - at, &frame, &used) != 1 ||
            (frame.type != WIRE_AUDIO && frame.type != WIRE_EVENTS)) {
            die(p, "sent garbage");
            return;
        }
        const struct buf payload = {(uint8_t *)frame.data, frame.size, 0};
        say(p, frame.type, &payload);
        at += used;
    }
}

static void on_answered(void *ctx, enum work_end end, const struct buf *body) {
    static const enum error_code codes[WORK_ENDS] = {
        [WORK_FAILED] = ERROR_VOICE_FAILED,    [WORK_CRASHED] = ERROR_VOICE_CRASHED,
        [WORK_TIMEOUT] = ERROR_VOICE_TIMEOUT,  [WORK_UNREACHED] = ERROR_VOICE_UNAVAILABLE,
        [WORK_FULL] = ERROR_VOICE_UNAVAILABLE,
    };
    struct far_process *p = ctx;
    p->task = NULL;
    if (end == WORK_SPOKEN) {
        say_again(p, body);
        say_done(p, ERROR_NONE, "");
        return;
    }
    char *text = mem_strndup((const char *)body->data, body->size < 200 ? body->size : 200);
    say_done(p, codes[end], text);
    free(text);
}

static void speak(struct far_process *p, const struct wire_frame *frame) {
    struct wire_reader r = wire_read(frame);
    (void)wire_get_u32(&r); /* processor time: its own pool says how much */
    const struct buf sentence = {(uint8_t *)r.at, (size_t)(r.end - r.at), 0};
    p->job = frame->job;
    p->task = work_put(p->work, p->queue, p->turn, p->payer, &sentence, on_answered, p);
    uv_timer_start(&p->pulse, on_pulse, WIRE_ALIVE_MS, WIRE_ALIVE_MS);
}

/* It has stopped as soon as it is told to; said from the timer, as who tells it does not expect it at once.
 */
static void on_cancelled(uv_timer_t *timer) {
    struct far_process *p = timer->data;
    say_done(p, ERROR_CANCELLED, "was told to stop");
}

static void send_far(struct process *process, struct buf *b) {
    struct far_process *p = (struct far_process *)process;
    struct wire_frame frame;
    size_t used;
    if (wire_next(b->data, b->size, &frame, &used) == 1 && frame.type == WIRE_SPEAK) {
        speak(p, &frame);
    } else if (frame.type == WIRE_CANCEL && frame.job == p->job && p->task) {
        work_cancel(p->task);
        p->task = NULL;
        uv_timer_start(&p->pulse, on_cancelled, 0, 0);
    }
    b->size = 0;
}

static void on_closed(uv_handle_t *handle) {
    struct far_process *p = handle->data;
    p->callbacks.gone(p->ctx);
    free(p);
}

static void stop_far(struct process *process, bool politely) {
    struct far_process *p = (struct far_process *)process;
    (void)politely;
    p->stopped = true;
    work_cancel(p->task);
    p->task = NULL;
    if (!uv_is_closing((uv_handle_t *)&p->pulse))
        uv_close((uv_handle_t *)&p->pulse, on_closed);
}

static const struct process_kind far_kind = {send_far, stop_far};

struct process *far_process_start(uv_loop_t *loop, struct work *work, const char *queue,
                                  const char *description, const struct process_callbacks *callbacks,
                                  void *ctx) {
    struct far_process *p = mem_alloc(sizeof *p);
    *p = (struct far_process){.process = {&far_kind},
                              .work = work,
                              .queue = queue,
                              .description = description,
                              .callbacks = *callbacks,
                              .ctx = ctx};
    uv_timer_init(loop, &p->pulse);
    p->pulse.data = p;
    uv_timer_start(&p->pulse, on_pulse, 0, 0);
    return &p->process;
}

void far_process_turn(struct process *process, enum voice_turn turn, uint32_t payer) {
    static const enum work_turn turns[] = {
        [VOICE_TURN_USUAL] = WORK_USUAL, [VOICE_TURN_URGENT] = WORK_URGENT, [VOICE_TURN_AHEAD] = WORK_AHEAD};
    struct far_process *p = (struct far_process *)process;
    p->turn = turns[turn];
    p->payer = payer;
}
