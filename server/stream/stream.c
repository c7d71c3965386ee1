/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/stream.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/stream/cut.h"
#include <stdlib.h>
#include <string.h>

/* Asked again this soon when the sink is not ready, ms. */
enum { RETRY_MS = 20 };

/* One utterance: a speech that speaks or waits, and the scenes of it that are ready. */
struct turn {
    struct turn *next;
    struct stream *stream;
    struct speech *speech;
    uint32_t utterance;
    struct scene *scenes; /* the first is being cut */
    size_t scene_count, scene_cap;
    struct cut cut;
    uint64_t asked; /* uv_hrtime of the request */
    bool started, begun, sentence_said;
    bool finished;              /* no further scene comes */
    size_t spoken;              /* scenes that came */
    uint32_t sent, sample_rate; /* samples that left */
    struct utf16_counter utf16;
};

struct stream {
    const struct studio *studio;
    struct stream_sink sink;
    void *ctx;
    uv_timer_t *timer;
    struct turn *turns; /* the first speaks */
    unsigned waiting, queue_limit;
    uint32_t utterances;   /* numbers given so far */
    uint64_t played_until; /* loop time at which all media sent will have been heard, ms */
};

static void pump(struct stream *s);

static void on_timer(uv_timer_t *timer) {
    pump(timer->data);
}

static void wake_in(struct stream *s, uint64_t ms) {
    uv_timer_start(s->timer, on_timer, ms, 0);
}

static void give(struct turn *t, struct stream_event event) {
    event.utterance = t->utterance;
    event.id = t->speech ? speech_request(t->speech)->id : event.id;
    event.sample_rate = t->sample_rate;
    t->stream->sink.event(t->stream->ctx, &event);
}

static void drop_scene(struct turn *t) {
    scene_free(&t->scenes[0]);
    t->scene_count--;
    memmove(t->scenes, t->scenes + 1, t->scene_count * sizeof *t->scenes);
    t->cut = (struct cut){0};
    t->sentence_said = false;
}

/* Ends the first turn. */
static void end_turn(struct stream *s, const char *reason) {
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
    while (t->scene_count)
        drop_scene(t);
    speech_free(t->speech);
    free(t->scenes);
    free(t);
}

static void on_scene(void *ctx, struct scene scene) {
    struct turn *t = ctx;
    t->scenes = mem_grow(t->scenes, &t->scene_cap, t->scene_count + 1, sizeof *t->scenes);
    t->scenes[t->scene_count++] = scene;
    wake_in(t->stream, 0);
}

static void on_problem(void *ctx, const struct error *e, bool warning) {
    give(ctx, (struct stream_event){.kind = warning ? STREAM_WARNING : STREAM_ERROR, .error = e});
}

static void start(struct turn *t) {
    if (t && !t->started)
        speech_start(t->speech);
    if (t)
        t->started = true;
}

static void on_finished(void *ctx, size_t spoken) {
    struct turn *t = ctx;
    t->finished = true;
    t->spoken = spoken;
    start(t->next); /* so that it follows without a gap */
    wake_in(t->stream, 0);
}

static const struct speech_callbacks speech_callbacks = {on_scene, on_problem, on_finished};

static void say_begin(struct turn *t) {
    t->begun = true;
    metrics_first_media(t->stream->studio->metrics, (double)(uv_hrtime() - t->asked) / 1e9);
    t->sample_rate = t->scenes[0].utterance->sample_rate;
    give(t, (struct stream_event){.kind = STREAM_BEGIN,
                                  .voice = speech_voice(t->speech)->id,
                                  .lang = speech_lang(t->speech),
                                  .engine = speech_engine(t->speech),
                                  .fps = speech_request(t->speech)->fps});
}

static void say_place(struct turn *t, enum stream_event_kind kind, uint32_t from, uint32_t to, size_t start,
                      size_t end) {
    const char *text = speech_request(t->speech)->text;
    size_t utf16_start = utf16_offset(&t->utf16, text, start);
    give(t, (struct stream_event){.kind = kind,
                                  .sample = t->scenes[0].start + from,
                                  .duration = to - from,
                                  .start = start,
                                  .end = end,
                                  .utf16_start = utf16_start,
                                  .utf16_end = utf16_offset(&t->utf16, text, end),
                                  .text = text + start});
}

/* What begins before the cut and has not been said. */
static void say_events(struct turn *t) {
    const struct utterance *u = t->scenes[0].utterance;
    bool last = t->cut.at == u->samples;
    if (!t->sentence_said)
        say_place(t, STREAM_SENTENCE, 0, u->samples, u->from, u->to);
    t->sentence_said = true;
    for (; t->cut.word < u->word_count && (last || u->words[t->cut.word].start < t->cut.at); t->cut.word++) {
        const struct word *w = &u->words[t->cut.word];
        say_place(t, STREAM_WORD, w->start, w->end, w->from, w->to);
    }
    for (; t->cut.mark < u->mark_count && (last || u->marks[t->cut.mark].at < t->cut.at); t->cut.mark++) {
        const struct mark *m = &u->marks[t->cut.mark];
        give(t, (struct stream_event){
                    .kind = STREAM_MARK, .sample = t->scenes[0].start + m->at, .text = m->name});
    }
}

static void send_chunk(struct turn *t) {
    struct stream *s = t->stream;
    struct fap_frame frames[CUT_FRAMES];
    struct chunk chunk;
    uint32_t rate = t->scenes[0].utterance->sample_rate;
    cut_chunk(&t->cut, &t->scenes[0], speech_request(t->speech)->fps, rate * STREAM_CHUNK_MS / 1000, &chunk,
              frames);
    chunk.utterance = t->utterance;
    say_events(t);
    t->sent += chunk.samples;
    uint64_t now = uv_now(s->studio->loop);
    if (s->played_until < now)
        s->played_until = now;
    s->played_until += (uint64_t)chunk.samples * 1000 / rate;
    s->sink.media(s->ctx, &chunk, frames);
    if (t->cut.at == t->scenes[0].utterance->samples) {
        drop_scene(t);
        speech_release(t->speech);
    }
}

/* Sends what may be sent now, and sees to it that it is called again when more may. */
static void pump(struct stream *s) {
    for (struct turn *t; (t = s->turns);) {
        if (t->finished && !t->scene_count) {
            end_turn(s, t->spoken ? "done" : "failed");
            start(s->turns);
            continue;
        }
        if (!t->scene_count)
            return;
        if (!s->sink.ready(s->ctx)) {
            wake_in(s, RETRY_MS);
            return;
        }
        uint64_t now = uv_now(s->studio->loop);
        if (s->played_until >= now + STREAM_LEAD_MS) {
            wake_in(s, s->played_until - now - STREAM_LEAD_MS + 1);
            return;
        }
        if (!t->begun)
            say_begin(t);
        send_chunk(t);
    }
}

struct stream *stream_new(const struct studio *studio, const struct stream_sink *sink, void *ctx,
                          unsigned queue) {
    struct stream *s = mem_alloc(sizeof *s);
    s->studio = studio;
    s->sink = *sink;
    s->ctx = ctx;
    s->queue_limit = queue;
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
    stream_stop(s);
    uv_close((uv_handle_t *)s->timer, free_timer);
    free(s);
}

void stream_refuse(struct stream *s, const char *id, const struct error *e) {
    struct turn t = {.stream = s, .utterance = ++s->utterances};
    give(&t, (struct stream_event){.kind = STREAM_ERROR, .error = e, .id = id});
    give(&t, (struct stream_event){.kind = STREAM_END, .reason = "failed", .id = id});
}

void stream_speak(struct stream *s, const struct speech_request *request) {
    struct error e;
    if (s->waiting >= s->queue_limit) {
        error_set(&e, "queue-full", "%u utterances wait already", s->waiting);
        stream_refuse(s, request->id, &e);
        return;
    }
    struct turn *t = mem_alloc(sizeof *t);
    t->stream = s;
    t->asked = uv_hrtime();
    t->speech = speech_open(s->studio, request, &speech_callbacks, t, &e);
    if (!t->speech) {
        free(t);
        stream_refuse(s, request->id, &e);
        return;
    }
    t->utterance = ++s->utterances;
    struct turn **last = &s->turns;
    while (*last)
        last = &(*last)->next;
    *last = t;
    if (t == s->turns)
        start(t);
    else
        s->waiting++;
}

bool stream_busy(const struct stream *s) {
    return s->turns != NULL;
}

void stream_stop(struct stream *s) {
    uv_timer_stop(s->timer);
    while (s->turns)
        end_turn(s, "stopped");
    s->played_until = 0;
}
