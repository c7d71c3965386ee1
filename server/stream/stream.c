/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/stream.h"
#include "server/base/mem.h"
#include "server/stream/stream_internal.h"
#include <stdlib.h>

static void give(const struct utterance *t, struct stream_event event) {
    utterance_give(t, &t->stream->sink, t->stream->ctx, event);
}

static void on_segment(void *ctx, struct media_segment segment) {
    struct utterance *t = ctx;
    utterance_add_segment(t, segment);
    stream_wake(t->stream, 0);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    give(ctx, (struct stream_event){.kind = warning ? STREAM_WARNING : STREAM_ERROR, .error = e});
}

static void on_finished(void *ctx, size_t spoken) {
    struct utterance *t = ctx;
    t->finished = true;
    t->spoken = spoken;
    if (t->next && t->started)    /* one that could not be read is finished before its turn comes */
        utterance_start(t->next); /* so that it follows without a gap */
    stream_wake(t->stream, 0);
}

const struct synthesis_callbacks utterance_callbacks = {on_segment, on_problem, on_finished};

struct stream *stream_new(const struct pipeline *pipeline, const struct stream_sink *sink, void *ctx,
                          unsigned queue) {
    struct stream *s = mem_alloc(sizeof *s);
    s->pipeline = pipeline;
    s->sink = *sink;
    s->ctx = ctx;
    s->queue_limit = queue;
    s->idling.life = 1;
    mood_mix_open(&s->mix, pipeline->expressions);
    s->timer = mem_alloc(sizeof *s->timer);
    uv_timer_init(pipeline->loop, s->timer);
    s->timer->data = s;
    return s;
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

static void ignore_event(void *ctx, const struct stream_event *event) {
    (void)ctx;
    (void)event;
}

void stream_free(struct stream *s) {
    if (!s)
        return;
    s->sink.event = ignore_event;
    stream_idle(s, NULL);
    stream_stop(s);
    mood_mix_close(&s->mix);
    uv_close((uv_handle_t *)s->timer, free_timer);
    free(s);
}

void stream_refuse(struct stream *s, const char *id, uint64_t order, const struct error *e) {
    struct utterance t = {.stream = s, .number = ++s->utterances, .order = order};
    give(&t, (struct stream_event){.kind = STREAM_ERROR, .error = e, .id = id});
    give(&t, (struct stream_event){.kind = STREAM_END, .reason = "failed", .id = id});
}

bool stream_busy(const struct stream *s) {
    return s->queue != NULL;
}

uint32_t stream_number(const struct stream *s) {
    return s->utterances;
}

void stream_number_above(struct stream *s, uint32_t number) {
    if (s->utterances < number)
        s->utterances = number;
}

/* e: what is said of each, or NULL. */
static void end_all(struct stream *s, const char *reason, const struct error *e) {
    uv_timer_stop(s->timer);
    while (s->queue) {
        const struct utterance *t = s->queue;
        bool spared = e && t->spared;
        if (e && (!spared || t->begun))
            give(t, (struct stream_event){.kind = spared ? STREAM_WARNING : STREAM_ERROR, .error = e});
        stream_end_utterance(s, spared ? NULL : reason);
    }
    stream_forget_unheard(s);
    stream_resume(s);
    if (s->idle)
        stream_wake(s, 0);
}

void stream_stop(struct stream *s) {
    end_all(s, "stopped", NULL);
}

void stream_fail(struct stream *s, const struct error *e) {
    end_all(s, "failed", e);
}

/* Another seed, or more or less of life: for what speaks, too. */
static void live_otherwise(struct stream *s) {
    stream_cut_face(s);
    if (s->queue && s->queue->begun && !utterance_is_apart(s->queue))
        utterance_unplace(s->queue);
}

void stream_idle(struct stream *s, const struct idle_options *options) {
    if (options && s->idle && idle_face_is(s->idle, options))
        return;
    idle_face_free(s->idle);
    s->idle = NULL;
    if (!options)
        return;
    if (options->life != s->idling.life || options->seed != s->idling.seed ||
        options->still != s->idling.still)
        live_otherwise(s);
    s->idling = *options;
    s->idle = idle_face_new(options, s->mix.mood, uv_now(s->pipeline->loop));
    stream_wake(s, 0);
}

int stream_express(struct stream *s, const struct mood_request *mix, struct error *e) {
    if (mood_mix_set(&s->mix, mix, s->life, e))
        return -1;
    for (const struct utterance *t = s->queue; t; t = t->next)
        mood_mix_follow(&s->mix, t->mood, t->sent ? (double)t->sent / t->sample_rate : 0);
    return 0;
}
