/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/stream.h"
#include "server/base/mem.h"
#include "server/stream/stream_parts.h"
#include <stdlib.h>

/* Asked again this soon when the sink is not ready, ms. */
enum { RETRY_MS = 20 };

static void pump(struct stream *s);

static void on_timer(uv_timer_t *timer) {
    pump(timer->data);
}

void stream_wake(struct stream *s, uint64_t ms) {
    uv_timer_start(s->timer, on_timer, ms, 0);
}

static void give(const struct turn *t, struct stream_event event) {
    turn_give(t, &t->stream->sink, t->stream->ctx, event);
}

static uint64_t later(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

/* What the life clock shows at a loop time. */
static double life_at(const struct stream *s, uint64_t at) {
    return s->life + ((double)at - (double)s->played_until) / 1000;
}

/* Media go on from the loop time `at`: what was sent for later is forgotten. */
void stream_go_on_from(struct stream *s, uint64_t at) {
    s->life = s->played_until ? life_at(s, at) : 0;
    s->played_until = at;
}

/* Ends the first turn. */
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

/* Where on the life clock an utterance begins: when those before it have ended, or now. */
static double place(const struct turn *turn) {
    const struct stream *s = turn->stream;
    uint64_t start = later(uv_now(s->studio->loop), s->spoken_until);
    double life = s->played_until ? life_at(s, start) : 0;
    for (const struct turn *t = s->turns; t != turn; t = t->next)
        if (t->placed)
            life = t->life_begin + t->length;
    return life;
}

static void on_face(void *ctx, struct face_options *options) {
    struct turn *t = ctx;
    struct stream *s = t->stream;
    const struct speech_request *request = speech_request(t->speech);
    if (!t->placed)
        t->life_begin = place(t);
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

static void start(struct turn *t) {
    if (t)
        turn_start(t);
}

static void on_finished(void *ctx, size_t spoken) {
    struct turn *t = ctx;
    t->finished = true;
    t->spoken = spoken;
    start(t->next); /* so that it follows without a gap */
    stream_wake(t->stream, 0);
}

static const struct speech_callbacks speech_callbacks = {on_scene, on_problem, on_finished};

double stream_idle_time(const struct stream *s, uint64_t at) {
    return s->idle ? idle_time(s->idle, at) : -1;
}

static void say_begin(struct turn *t) {
    struct stream *s = t->stream;
    uint64_t start = later(uv_now(s->studio->loop), s->spoken_until);
    if (!t->placed)
        t->life_begin = place(t);
    t->placed = true;
    stream_go_on_from(s, start);
    s->life = t->life_begin;
    t->begun = true;
    metrics_first_media(t->stream->studio->metrics, (double)(uv_hrtime() - t->asked) / 1e9);
    t->sample_rate = t->scenes[0].utterance->sample_rate;
    struct stream_event begin = {
        .kind = STREAM_BEGIN, .fps = turn_fps(t), .idle = stream_idle_time(s, start)};
    if (t->reel) {
        begin.play = reel_name(t->reel);
    } else {
        begin.voice = speech_voice(t->speech)->id;
        begin.lang = speech_lang(t->speech);
        begin.engine = speech_engine(t->speech);
        begin.markup = speech_markup(t->speech);
    }
    give(t, begin);
}

static void send_speech(struct turn *t) {
    struct stream *s = t->stream;
    struct fap_frame frames[CUT_FRAMES];
    struct chunk chunk;
    if (!t->begun)
        say_begin(t);
    turn_cut(t, &s->sink, s->ctx, &chunk, frames);
    /* late media hold the life clock up: it is theirs */
    s->played_until =
        later(s->played_until, uv_now(s->studio->loop)) + (uint64_t)chunk.samples * 1000 / chunk.sample_rate;
    s->spoken_until = s->played_until;
    s->life = t->life_begin + (double)t->sent / chunk.sample_rate;
    s->sink.media(s->ctx, &chunk, frames);
    turn_drop_scene_if_done(t);
}

static void send_idle(struct stream *s) {
    struct fap_frame frames[IDLE_FRAMES];
    struct chunk chunk;
    stream_go_on_from(s, later(s->played_until, uv_now(s->studio->loop)));
    idle_chunk(s->idle, s->played_until, s->life, &chunk, frames);
    stream_go_on_from(s, s->played_until + IDLE_CHUNK_MS);
    s->sink.media(s->ctx, &chunk, frames);
}

/* Sends what may be sent now, and sees to it that it is called again when more may. */
static void pump(struct stream *s) {
    for (;;) {
        struct turn *t = s->paused ? NULL : s->turns;
        if (t && t->finished && !t->scene_count) {
            stream_end_turn(s, t->spoken ? "done" : "failed");
            start(s->turns);
            continue;
        }
        bool speaks = t && t->scene_count;
        if (!speaks && (!s->idle || (t && t->begun)))
            return;
        if (!s->sink.ready(s->ctx)) {
            stream_wake(s, RETRY_MS);
            return;
        }
        uint64_t now = uv_now(s->studio->loop);
        uint64_t lead = speaks ? STREAM_LEAD_MS : IDLE_LEAD_MS - IDLE_CHUNK_MS + 1;
        uint64_t until = speaks && !t->begun ? s->spoken_until : s->played_until;
        if (until >= now + lead) {
            stream_wake(s, until - now - lead + 1);
            return;
        }
        if (speaks)
            send_speech(t);
        else
            send_idle(s);
    }
}

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
        start(t);
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
    t->reel = reel_open(s->studio->loop, source, &speech_callbacks, t);
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
