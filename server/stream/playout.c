/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Playout: cuts segments into chunks and sends them on time, from the first utterance or from idling. */
#include "server/stream/media.h"
#include "server/stream/stream_internal.h"
#include "server/synthesis/media_segment.h"
#include <math.h>
#include <string.h>

enum {
    RETRY_MS = 20, /* delay before retrying when the sink is not ready */
    /* While the face is driven: chunks are short and leave when they are over, so that they show the present;
     * those of speech keep the lead that its sound needs. */
    DRIVE_CHUNK_MS = 40,
    DRIVE_SPEECH_MS = 100,
    DRIVE_LEAD_MS = 100,
    DRIVE_VOICE_MS = 40, /* of a live voice, beside its lookahead, before it leaves */
};

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
    if (utterance_is_foreign(t) || s->drive)
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

/* Lays the driver's face over frames that are to be shown from loop time `at` on, or over those of the mouth
 * too; `late`: s by which the driver's face is shown after its time. */
static void drive(struct stream *s, uint64_t at, double late, bool mouth, struct media *media) {
    for (uint32_t k = 0; s->drive && k < media->frame_count; k++) {
        double in = (media->first_frame + k) / media->fps - (double)media->start / media->sample_rate;
        drive_track_show(s->drive, (double)at / 1000 + in - late, mouth, &media->frames[k]);
    }
}

/* The driver's own voice has the driver's mouth, as late as its sound; any other speech has its own. */
static void drive_speech(struct utterance *t, uint64_t at, struct media *media) {
    struct stream *s = t->stream;
    struct source_description source = {0};
    if (!s->drive || utterance_is_apart(t))
        return;
    t->source->ops->describe(t->source, &source);
    double lag = drive_track_lag(s->drive);
    double late = source.live ? fmax(0, (source.lookahead + DRIVE_VOICE_MS) / 1000. - lag)
                              : (DRIVE_LEAD_MS + DRIVE_SPEECH_MS) / 1000.;
    drive(s, at, late, t->number == s->driver_voice, media);
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
    unsigned ms = !t->sent ? STREAM_FIRST_MS : s->drive ? DRIVE_SPEECH_MS : STREAM_CHUNK_MS;
    utterance_cut(t, ms, &s->sink, s->ctx, &media);
    drive_speech(t, later(s->played_until, now), &media);
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
    uint64_t now = uv_now(s->pipeline->loop), from = later(s->played_until, now);
    unsigned ms = s->drive ? DRIVE_CHUNK_MS : IDLE_CHUNK_MS;
    if (s->drive && s->played_until + ms < now) /* the chunk that is over just now */
        from = later(s->played_until, now - IDLE_CHUNK_MS);
    else if (s->drive && s->played_until)
        from = s->played_until;
    stream_go_on_from(s, from);
    idle_face_media(s->idle, s->played_until, ms, s->life, &media);
    drive(s, from, 0, true, &media);
    stream_go_on_from(s, s->played_until + ms);
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
    if (t->begun && (!done || utterance_is_foreign(t) || s->drive))
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
        int64_t lead = speaks     ? s->drive ? DRIVE_LEAD_MS : STREAM_LEAD_MS
                       : waits    ? utterance_patience(t)
                       : s->drive ? -DRIVE_CHUNK_MS
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
