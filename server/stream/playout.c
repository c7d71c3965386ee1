/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What drives a stream: media go out as they are due, those of the first turn or of idling. */
#include "server/stream/stream_internal.h"

/* Asked again this soon when the sink is not ready, ms. */
enum { RETRY_MS = 20 };

static uint64_t later(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

/* What the life clock shows at a loop time. */
static double life_at(const struct stream *s, uint64_t at) {
    return s->life + ((double)at - (double)s->played_until) / 1000;
}

void stream_go_on_from(struct stream *s, uint64_t at) {
    s->life = s->played_until ? life_at(s, at) : 0;
    s->played_until = at;
}

double stream_idle_time(const struct stream *s, uint64_t at) {
    return s->idle ? idle_face_time(s->idle, at) : -1;
}

double stream_place(const struct utterance *utterance) {
    const struct stream *s = utterance->stream;
    uint64_t start = later(uv_now(s->pipeline->loop), s->spoken_until);
    double life = s->played_until ? life_at(s, start) : 0;
    for (const struct utterance *t = s->queue; t != utterance; t = t->next)
        if (t->placed)
            life = t->life_begin + t->length;
    return life;
}

static void say_begin(struct utterance *t) {
    struct stream *s = t->stream;
    uint64_t start = later(uv_now(s->pipeline->loop), s->spoken_until);
    if (!t->placed)
        t->life_begin = stream_place(t);
    t->placed = true;
    stream_go_on_from(s, start);
    s->life = t->life_begin;
    t->begun = true;
    metrics_first_media(t->stream->pipeline->metrics, (double)(uv_hrtime() - t->asked) / 1e9);
    t->sample_rate = t->segments[0].audio->sample_rate;
    struct stream_event begin = {
        .kind = STREAM_BEGIN, .fps = utterance_fps(t), .idle = stream_idle_time(s, start)};
    if (t->recording) {
        begin.play = recording_name(t->recording);
    } else {
        begin.voice = synthesis_voice(t->synthesis)->id;
        begin.lang = synthesis_lang(t->synthesis);
        begin.engine = synthesis_engine(t->synthesis);
        begin.markup = synthesis_markup(t->synthesis);
    }
    utterance_give(t, &s->sink, s->ctx, begin);
}

static void send_speech(struct utterance *t) {
    struct stream *s = t->stream;
    struct fap_frame frames[CUT_FRAMES];
    struct chunk chunk;
    if (!t->begun)
        say_begin(t);
    utterance_cut(t, &s->sink, s->ctx, &chunk, frames);
    /* late media hold the life clock up: it is theirs */
    s->played_until = later(s->played_until, uv_now(s->pipeline->loop)) +
                      (uint64_t)chunk.samples * 1000 / chunk.sample_rate;
    s->spoken_until = s->played_until;
    s->life = t->life_begin + (double)t->sent / chunk.sample_rate;
    s->sink.media(s->ctx, &chunk, frames);
    utterance_drop_segment_if_done(t);
}

static void send_idle(struct stream *s) {
    struct fap_frame frames[IDLE_FRAMES];
    struct chunk chunk;
    stream_go_on_from(s, later(s->played_until, uv_now(s->pipeline->loop)));
    idle_face_chunk(s->idle, s->played_until, s->life, &chunk, frames);
    stream_go_on_from(s, s->played_until + IDLE_CHUNK_MS);
    s->sink.media(s->ctx, &chunk, frames);
}

/* Sends what may be sent now, and sees to it that it is called again when more may. */
static void pump(struct stream *s) {
    for (;;) {
        struct utterance *t = s->paused ? NULL : s->queue;
        if (t && t->finished && !t->segment_count) {
            stream_end_utterance(s, t->spoken ? "done" : "failed");
            if (s->queue)
                utterance_start(s->queue);
            continue;
        }
        bool speaks = t && t->segment_count;
        if (!speaks && (!s->idle || (t && t->begun)))
            return;
        if (!s->sink.ready(s->ctx)) {
            stream_wake(s, RETRY_MS);
            return;
        }
        uint64_t now = uv_now(s->pipeline->loop);
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

static void on_timer(uv_timer_t *timer) {
    pump(timer->data);
}

void stream_wake(struct stream *s, uint64_t ms) {
    uv_timer_start(s->timer, on_timer, ms, 0);
}
