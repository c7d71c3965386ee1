/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/stream.h"
#include "server/base/mem.h"
#include "server/stream/stream_parts.h"
#include <stdlib.h>

static void give(const struct turn *t, struct stream_event event) {
    turn_give(t, &t->stream->sink, t->stream->ctx, event);
}

void stream_end_turn(struct stream *s, const char *reason) {
    struct turn *t = s->turns;
    struct metrics *metrics = s->studio->metrics;
    s->turns = t->next;
    metrics_add(metrics,
                *reason == 'd'   ? METRIC_UTTERANCES_DONE
                : *reason == 's' ? METRIC_UTTERANCES_STOPPED
                                 : METRIC_UTTERANCES_FAILED,
                1);
    if (t->sample_rate)
        metrics_add(metrics, METRIC_SPEECH_SECONDS, (double)t->sent / t->sample_rate);
    if (s->waiting)
        s->waiting--;
    give(t, (struct stream_event){.kind = STREAM_END, .duration = t->sent, .reason = reason});
    turn_free(t);
}

static void on_face(void *ctx, struct face_options *options) {
    struct turn *t = ctx;
    struct stream *s = t->stream;
    const struct speech_request *request = speech_request(t->speech);
    if (!t->placed)
        t->life_begin = stream_place(t);
    t->placed = true;
    if (request->life < 0)
        options->life = s->idling.life;
    options->mood = s->mix.mood;
    if (request->seed < 0) {
        options->seed = s->idling.seed;
        options->begin += t->life_begin;
        return;
    }
    if (!t->mood)
        t->mood = mix_copy(&s->mix);
    options->mood = t->mood;
}

static void on_scene(void *ctx, struct scene scene) {
    struct turn *t = ctx;
    turn_add_scene(t, scene);
    stream_wake(t->stream, 0);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    give(ctx, (struct stream_event){.kind = warning ? STREAM_WARNING : STREAM_ERROR, .error = e});
}

static void on_finished(void *ctx, size_t spoken) {
    struct turn *t = ctx;
    t->finished = true;
    t->spoken = spoken;
    if (t->next && t->started) /* one that could not be read is finished before its turn comes */
        turn_start(t->next);   /* so that it follows without a gap */
    stream_wake(t->stream, 0);
}

static const struct speech_callbacks speech_callbacks = {on_scene, on_problem, on_finished};

struct stream *stream_new(const struct studio *studio, const struct stream_sink *sink, void *ctx,
                          unsigned queue) {
    struct stream *s = mem_alloc(sizeof *s);
    s->studio = studio;
    s->sink = *sink;
    s->ctx = ctx;
    s->queue_limit = queue;
    s->idling.life = 1;
    mix_open(&s->mix, studio->expressions);
    s->timer = mem_alloc(sizeof *s->timer);
    uv_timer_init(studio->loop, s->timer);
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
    mix_close(&s->mix);
    uv_close((uv_handle_t *)s->timer, free_timer);
    free(s);
}

void stream_refuse(struct stream *s, const char *id, const struct error *e) {
    struct turn t = {.stream = s, .utterance = ++s->utterances};
    give(&t, (struct stream_event){.kind = STREAM_ERROR, .error = e, .id = id});
    give(&t, (struct stream_event){.kind = STREAM_END, .reason = "failed", .id = id});
}

/* Puts it among the turns, in the place that its mode asks for. */
static void take_turn(struct stream *s, struct turn *t, enum speech_mode mode) {
    if (mode == SPEAK_REPLACE)
        stream_stop(s);
    if (mode == SPEAK_INTERRUPT && s->turns) {
        stream_end_turn(s, "stopped");
        stream_forget_unheard(s);
    }
    if (mode == SPEAK_INTERRUPT)
        stream_resume(s);
    struct turn **at = &s->turns;
    while (*at && mode == SPEAK_QUEUE)
        at = &(*at)->next;
    t->utterance = ++s->utterances;
    t->next = *at;
    *at = t;
    s->waiting += s->turns->next != NULL;
    if (t->next)
        turn_unplace(t->next);
    if (t == s->turns)
        turn_start(t);
}

/* Whether one more may wait. */
static bool has_room(struct stream *s, const char *id, enum speech_mode mode) {
    struct error e;
    if (mode != SPEAK_QUEUE || s->waiting < s->queue_limit)
        return true;
    error_set(&e, "queue-full", "%u utterances wait already", s->waiting);
    stream_refuse(s, id, &e);
    return false;
}

static struct turn *turn_new(struct stream *s) {
    struct turn *t = mem_alloc(sizeof *t);
    t->stream = s;
    t->asked = uv_hrtime();
    return t;
}

void stream_speak(struct stream *s, const struct speech_request *request) {
    struct error e;
    if (!has_room(s, request->id, request->mode))
        return;
    struct turn *t = turn_new(s);
    t->speech = speech_open(s->studio, request, &speech_callbacks, t, &e);
    if (!t->speech) {
        free(t);
        stream_refuse(s, request->id, &e);
        return;
    }
    speech_direct_face(t->speech, on_face);
    take_turn(s, t, request->mode);
}

void stream_play(struct stream *s, struct reel_source *source, enum speech_mode mode) {
    if (!has_room(s, source->id, mode)) {
        reel_source_free(source);
        return;
    }
    struct turn *t = turn_new(s);
    t->reel = reel_open(s->studio->loop, s->studio->high_level, source, &speech_callbacks, t);
    take_turn(s, t, mode);
}

bool stream_busy(const struct stream *s) {
    return s->turns != NULL;
}

void stream_forget_unheard(struct stream *s) {
    uint64_t now = uv_now(s->studio->loop);
    if (!s->paused && s->spoken_until > now)
        stream_go_on_from(s, now);
    s->spoken_until = 0;
    s->unheard = 0;
}

void stream_stop(struct stream *s) {
    uv_timer_stop(s->timer);
    while (s->turns)
        stream_end_turn(s, "stopped");
    stream_forget_unheard(s);
    stream_resume(s);
    if (s->idle)
        stream_wake(s, 0);
}

void stream_idle(struct stream *s, const struct idle_options *options) {
    if (options && s->idle && idle_is(s->idle, options))
        return;
    idle_free(s->idle);
    s->idle = NULL;
    if (!options)
        return;
    s->idling = *options;
    s->idle = idle_new(s->studio, options, s->mix.mood, uv_now(s->studio->loop));
    stream_wake(s, 0);
}

int stream_express(struct stream *s, const struct stream_mix *mix, struct error *e) {
    if (mix_set(&s->mix, mix, s->life, e))
        return -1;
    for (const struct turn *t = s->turns; t; t = t->next)
        mix_follow(&s->mix, t->mood, t->sent ? (double)t->sent / t->sample_rate : 0);
    return 0;
}
