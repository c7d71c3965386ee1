/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Playout: cuts segments into chunks and sends them on time, from the first utterance or from idling. */
#include "server/stream/media.h"
#include "server/stream/stream_internal.h"
#include "server/synthesis/media_segment.h"
#include <string.h>

/* Delay before retrying when the sink is not ready, ms. */
enum { RETRY_MS = 20 };

static uint64_t later(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

/* Converts loop time to the life clock. */
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

void stream_cut_face(struct stream *s) {
    face_ease_cut(&s->ease, NULL, uv_now(s->pipeline->loop));
}

/* Places the face of the next segment: on the stream's clock, with its life and mood, or on the
 * utterance's own. */
static void place(struct utterance *t) {
    struct stream *s = t->stream;
    struct placement_options options = t->segments[0].alone;
    const struct speech_request *request = t->source->request;
    if (request && request->life < 0)
        options.life = s->idling.life;
    if (!utterance_is_apart(t)) {
        options.seed = s->idling.seed;
        options.begin += t->life_begin;
        options.mood = s->mix.mood;
    } else if (t->source->text) {
        if (!t->mood)
            t->mood = mood_mix_copy(&s->mix);
        options.mood = t->mood;
    }
    t->face = media_segment_place(&t->segments[0], &options);
}

static void say_begin(struct utterance *t) {
    struct stream *s = t->stream;
    struct source_description source;
    t->source->ops->describe(t->source, &source);
    uint64_t start = later(uv_now(s->pipeline->loop), s->spoken_until);
    stream_go_on_from(s, start);
    t->life_begin = s->life;
    t->begun = true;
    if (utterance_is_foreign(t))
        stream_cut_face(s);
    if (!source.live && !(t->source->text && t->source->request->open)) /* its writer may be slow */
        metrics_first_media(t->stream->pipeline->metrics, (double)(uv_hrtime() - t->asked) / 1e9);
    t->sample_rate = t->segments[0].audio->sample_rate;
    utterance_give(t, &s->sink, s->ctx,
                   (struct stream_event){.kind = STREAM_BEGIN,
                                         .fps = utterance_fps(t),
                                         .idle = stream_idle_time(s, start),
                                         .again = t->spared,
                                         .play = source.name,
                                         .bell = source.bell,
                                         .voice = source.voice,
                                         .lang = source.lang,
                                         .engine = source.engine,
                                         .markup = source.markup,
                                         .live = source.live,
                                         .lookahead = source.lookahead});
}

static void send_speech(struct utterance *t) {
    struct stream *s = t->stream;
    struct fap_frame frames[CUT_FRAMES];
    struct media media = {.frames = frames};
    uint64_t now = uv_now(s->pipeline->loop);
    if (!t->begun)
        say_begin(t);
    if (!t->face)
        place(t);
    utterance_cut(t, &s->sink, s->ctx, &media);
    face_ease_frames(&s->ease, utterance_is_apart(t) ? EASE_NOTHING : EASE_FACE, now, media.fps, frames,
                     media.frame_count);
    t->last = s->ease.last;
    /* late media delay the life clock with them */
    s->played_until = later(s->played_until, now) + (uint64_t)media.samples * 1000 / media.sample_rate;
    s->spoken_until = s->played_until;
    s->life = t->life_begin + (double)t->sent / media.sample_rate;
    s->sink.media(s->ctx, &media);
    utterance_drop_segment_if_done(t);
}

/* Sends the next idle chunk. If towards is set, it is number `piece` of `whole` chunks that end in that
 * face. */
static void send_idle(struct stream *s, const struct fap_frame *towards, size_t piece, size_t whole) {
    struct fap_frame frames[IDLE_FRAMES];
    struct media media = {.frames = frames};
    uint64_t now = uv_now(s->pipeline->loop);
    stream_go_on_from(s, later(s->played_until, now));
    idle_face_media(s->idle, s->played_until, s->life, &media);
    stream_go_on_from(s, s->played_until + IDLE_CHUNK_MS);
    face_ease_frames(&s->ease, EASE_ALL, now, media.fps, frames, media.frame_count);
    if (towards)
        face_ease_towards(towards, frames, (double)piece / (double)whole, (double)(piece + 1) / (double)whole,
                          media.frame_count);
    s->sink.media(s->ctx, &media);
}

/* Chunks of idling that return the face to where the utterance was paused, for clients that show frames on
 * arrival. Clients with a clock have switched to the utterance by then. */
enum { WAY_BACK = 3 };

void stream_resume_utterance(struct stream *s, uint64_t at) {
    struct utterance *t = s->queue;
    double sent = (double)t->sent / t->sample_rate, ahead = (double)s->unheard / 1000;
    if (!s->idle) {
        /* the clock stood still, too */
        s->life = t->life_begin + sent;
        if (!s->unheard)
            stream_cut_face(s);
    } else {
        for (size_t i = 0; s->unheard && i < WAY_BACK; i++)
            send_idle(s, &t->last, i, WAY_BACK);
        stream_go_on_from(s, at);
        s->life += ahead;
        t->life_begin = s->life - sent;
        if (!utterance_is_apart(t))
            utterance_unplace(t);
        face_ease_cut(&s->ease, s->unheard ? &t->last : NULL, at);
    }
    s->played_until = s->spoken_until = at + s->unheard;
}

void stream_end_utterance(struct stream *s, const char *reason) {
    struct utterance *t = s->queue;
    struct metrics *metrics = s->pipeline->metrics;
    bool done = reason && !strcmp(reason, "done");
    s->queue = t->next;
    metrics_add(metrics,
                done                                   ? METRIC_UTTERANCES_DONE
                : reason && !strcmp(reason, "stopped") ? METRIC_UTTERANCES_STOPPED
                                                       : METRIC_UTTERANCES_FAILED,
                1);
    if (t->sample_rate)
        metrics_add(metrics, METRIC_SPEECH_SECONDS, (double)t->sent / t->sample_rate);
    if (s->waiting)
        s->waiting--;
    if (t->begun && (!done || utterance_is_foreign(t)))
        stream_cut_face(s);
    utterance_give(t, &s->sink, s->ctx,
                   (struct stream_event){.kind = STREAM_END, .duration = t->sent, .reason = reason});
    utterance_free(t);
}

void stream_forget_unheard(struct stream *s) {
    uint64_t now = uv_now(s->pipeline->loop);
    if (!s->paused && s->spoken_until > now)
        stream_go_on_from(s, now);
    s->spoken_until = 0;
    s->unheard = 0;
}

/* Sends what is due and schedules the next call. */
static void pump(struct stream *s) {
    for (;;) {
        struct utterance *t = s->paused ? NULL : s->queue;
        if (t && t->finished && !t->segment_count) {
            stream_end_utterance(s, t->spoken ? "done" : "failed");
            if (s->queue)
                utterance_start(s->queue);
            continue;
        }
        bool speaks = t && t->segment_count, waits = t && utterance_awaits(t);
        if (!speaks && !waits && (!s->idle || (t && t->begun)))
            return;
        if (!s->sink.ready(s->ctx)) {
            stream_wake(s, RETRY_MS);
            return;
        }
        uint64_t now = uv_now(s->pipeline->loop);
        int64_t lead = speaks  ? STREAM_LEAD_MS
                       : waits ? utterance_patience(t)
                               : IDLE_LEAD_MS - IDLE_CHUNK_MS + 1;
        int64_t early =
            (int64_t)(speaks && !t->begun ? s->spoken_until : s->played_until) - (int64_t)now - lead;
        if (early >= 0) {
            stream_wake(s, (uint64_t)early + 1);
            return;
        }
        if (waits)
            t->source->ops->wait(t->source, STREAM_WAIT_MS);
        else if (speaks)
            send_speech(t);
        else
            send_idle(s, NULL, 0, 0);
    }
}

static void on_timer(uv_timer_t *timer) {
    pump(timer->data);
}

void stream_wake(struct stream *s, uint64_t ms) {
    uv_timer_start(s->timer, on_timer, ms, 0);
}
