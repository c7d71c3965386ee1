/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stream: its queue of utterances, open and live utterances, pause, rate and jumps. */
#include "server/stream/stream.h"
#include "server/base/mem.h"
#include "server/stream/stream_internal.h"
#include <stdlib.h>
#include <string.h>

static struct utterance *numbered(const struct stream *s, uint32_t number) {
    struct utterance *t = s->queue;
    while (t && t->number != number)
        t = t->next;
    return t;
}

static struct utterance *find(const struct stream *s, uint32_t number) {
    struct utterance *t = numbered(s, number);
    return t && t->source->text ? t : NULL;
}

static bool is_open(const struct utterance *t) {
    return t && t->source->ops->is_open && t->source->ops->is_open(t->source);
}

bool stream_is_open(const struct stream *s, uint32_t number) {
    return is_open(numbered(s, number));
}

void stream_sound(struct stream *s, uint32_t number, const uint8_t *bytes, size_t size) {
    struct utterance *t = numbered(s, number);
    if (t && t->source->ops->write_sound)
        t->source->ops->write_sound(t->source, bytes, size);
}

int stream_write(struct stream *s, uint32_t number, const char *text, size_t size, size_t most,
                 struct error *e) {
    struct utterance *t = find(s, number);
    return t ? synthesis_write(t->source->text, text, size, most, e) : 0;
}

void stream_flush(struct stream *s, uint32_t number) {
    struct utterance *t = find(s, number);
    if (t)
        synthesis_flush(t->source->text);
}

void stream_close(struct stream *s, uint32_t number, const struct error *why) {
    struct utterance *t = numbered(s, number);
    if (!is_open(t))
        return;
    if (why)
        utterance_give(t, &s->sink, s->ctx, (struct stream_event){.kind = STREAM_WARNING, .error = why});
    t->source->ops->close(t->source);
}

static void stream_forget(struct stream *s, struct utterance **at);

unsigned stream_cancel(struct stream *s, const char *id) {
    unsigned count = 0;
    bool first = false;
    for (struct utterance **at = &s->queue; *at;) {
        const char *own = utterance_id(*at);
        if (!own || strcmp(own, id)) {
            at = &(*at)->next;
            continue;
        }
        count++;
        first |= at == &s->queue;
        if (at == &s->queue)
            stream_end_utterance(s, "stopped");
        else
            stream_forget(s, at);
    }
    if (!first)
        return count;
    stream_forget_unheard(s);
    if (s->queue)
        utterance_start(s->queue);
    stream_wake(s, 0);
    return count;
}

/* Queue order: higher priorities come first. */

/* The part of a request that decides when its utterance is spoken. */
struct turn {
    const char *id, *topic; /* or NULL */
    enum speech_mode mode;
    enum speech_priority priority;
};

static struct turn turn_of(const struct speech_request *request) {
    return (struct turn){request->id, request->topic, request->mode, request->priority};
}

static void forget(struct stream *s, struct utterance **at, const char *reason) {
    struct utterance *t = *at;
    *at = t->next;
    s->waiting--;
    utterance_give(t, &s->sink, s->ctx, (struct stream_event){.kind = STREAM_END, .reason = reason});
    metrics_add(s->pipeline->metrics, METRIC_UTTERANCES_STOPPED, 1);
    utterance_free(t);
}

/* Drops a waiting utterance and reports its end. */
static void stream_forget(struct stream *s, struct utterance **at) {
    forget(s, at, "stopped");
}

/* Tells whether it was forwarded in an earlier session of that daemon; 0 = by any other daemon. */
static bool is_of_earlier(const struct utterance *t, uint64_t origin) {
    return t->origin && (!origin || (t->origin >> 32 == origin >> 32 && t->origin != origin));
}

uint32_t stream_forget_earlier(struct stream *s, uint64_t origin) {
    for (struct utterance **at = s->queue ? &s->queue->next : &s->queue; *at;) {
        if (is_of_earlier(*at, origin))
            forget(s, at, (*at)->spared ? NULL : "failed");
        else
            at = &(*at)->next;
    }
    if (!s->queue || !is_of_earlier(s->queue, origin))
        return 0;
    s->queue->spared = false;
    return s->queue->number;
}

void stream_go_alone(struct stream *s) {
    stream_forget_earlier(s, 0);
}

/* Tells whether it cuts the current utterance. */
static bool cuts(const struct stream *s, const struct turn *turn) {
    const struct utterance *speaks = s->queue;
    return speaks && (turn->mode == SPEAK_QUEUE ? speaks->priority < turn->priority
                                                : speaks->priority <= turn->priority);
}

/* Tells whether a new request with the same topic replaces the waiting utterance. */
static bool is_replaced(const struct utterance *t, const struct turn *turn) {
    const struct speech_request *request = t->source->request;
    const char *topic = request ? request->topic : NULL;
    return (turn->topic && topic && !strcmp(topic, turn->topic)) ||
           (turn->mode == SPEAK_REPLACE && t->priority <= turn->priority);
}

static void forget_replaced(struct stream *s, const struct turn *turn) {
    struct utterance **at = s->queue ? &s->queue->next : &s->queue;
    while (*at) {
        if (is_replaced(*at, turn))
            stream_forget(s, at);
        else
            at = &(*at)->next;
    }
}

static unsigned count_replaced(const struct stream *s, const struct turn *turn) {
    unsigned count = 0;
    for (const struct utterance *t = s->queue ? s->queue->next : NULL; t; t = t->next)
        count += is_replaced(t, turn);
    return count;
}

/* Returns the end of the waiting utterances of at least that priority. */
static struct utterance **last_below(struct stream *s, enum speech_priority priority) {
    struct utterance **at = s->queue ? &s->queue->next : &s->queue;
    while (*at && (*at)->next)
        at = &(*at)->next;
    return *at && (*at)->priority < priority ? at : NULL;
}

/* Checks whether it may be queued: -1 with *e. */
static int may_come(struct stream *s, const struct turn *turn, struct error *e) {
    if (turn->mode == SPEAK_QUIET && s->queue)
        return error_plain(e, ERROR_BUSY), -1;
    if (!s->queue || cuts(s, turn) || s->waiting - count_replaced(s, turn) < s->queue_limit ||
        last_below(s, turn->priority))
        return 0;
    return error_set(e, ERROR_QUEUE_FULL, "%u utterances are already queued", s->waiting);
}

static void cut(struct stream *s) {
    stream_end_utterance(s, "stopped");
    stream_forget_unheard(s);
}

/* Queues it at the place its priority and mode require. */
static void enqueue(struct stream *s, struct utterance *t, const struct turn *turn) {
    bool first = !s->queue || cuts(s, turn);
    if (turn->mode == SPEAK_REPLACE && first)
        stream_stop(s);
    forget_replaced(s, turn);
    if (first && s->queue)
        cut(s);
    if (first && (turn->mode == SPEAK_INTERRUPT || turn->priority == PRIORITY_ALARM))
        stream_resume(s);
    if (!first && s->waiting >= s->queue_limit)
        stream_forget(s, last_below(s, turn->priority));
    struct utterance **at = &s->queue;
    while (!first && *at &&
           ((*at)->priority > turn->priority || at == &s->queue ||
            (turn->mode == SPEAK_QUEUE && (*at)->priority == turn->priority)))
        at = &(*at)->next;
    t->priority = turn->priority;
    t->number = ++s->utterances;
    t->next = *at;
    *at = t;
    s->waiting += s->queue->next != NULL;
    if (t == s->queue)
        utterance_start(t);
}

/* Opens and queues an utterance. NULL, refused with *e. */
static struct utterance *add(struct stream *s, const struct speech_request *request, speech_source_open *open,
                             void *what, struct error *e) {
    struct turn turn = turn_of(request);
    struct utterance *t = NULL;
    if (!may_come(s, &turn, e)) {
        t = mem_alloc(sizeof *t);
        t->stream = s;
        t->asked = uv_hrtime();
        t->command = request->command;
        t->source = open(s->pipeline, what, &utterance_callbacks, t, e);
    }
    if (!t || !t->source) {
        free(t);
        stream_refuse(s, request->id, request->command, e);
        return NULL;
    }
    if (t->source->text) {
        t->origin = request->origin;
        t->spared = request->origin != 0 && request->again;
        synthesis_keep(t->source->text);
    }
    enqueue(s, t, &turn);
    return t;
}

int stream_set_lexicon(struct stream *s, const char *text, size_t size, struct error *e) {
    struct lexicon *lexicon = size ? lexicon_read_sent(text, size, e) : NULL;
    if (size && !lexicon)
        return -1;
    lexicons_free(&s->lexicons);
    if (lexicon)
        lexicons_add(&s->lexicons, lexicon);
    return 0;
}

uint32_t stream_speak(struct stream *s, const struct speech_request *request, struct error *why) {
    struct error e;
    struct speech_request around = *request;
    around.around = &s->lexicons;
    const struct utterance *t = add(s, &around, synthesis_open_source, &around, &e);
    if (!t && why)
        *why = e;
    return t ? t->number : 0;
}

uint32_t stream_play(struct stream *s, const struct speech_request *request, speech_source_open *open,
                     void *what) {
    struct error e;
    const struct utterance *t = add(s, request, open, what, &e);
    return t ? t->number : 0;
}

/* Control of the current utterance: pause and resume, rate, jumps. */

static uint64_t now_of(const struct stream *s) {
    return uv_now(s->pipeline->loop);
}

/* Reports an event at the sample being heard, or without an utterance if none has begun. */
static void tell(struct stream *s, enum stream_event_kind kind, const char *text) {
    const struct utterance *t = s->queue;
    struct stream_event event = {.kind = kind, .text = text, .idle = -1};
    if (kind == STREAM_RESUMED)
        event.idle = stream_idle_time(s, now_of(s));
    if (!t || (!t->begun && kind != STREAM_JUMPED)) {
        s->sink.event(s->ctx, &event);
        return;
    }
    event.sample = utterance_heard(t, kind == STREAM_JUMPED ? 0 : s->unheard);
    utterance_give(t, &s->sink, s->ctx, event);
}

void stream_pause(struct stream *s) {
    uint64_t now = now_of(s);
    if (s->paused)
        return;
    s->unheard = s->spoken_until > now ? s->spoken_until - now : 0;
    if (s->unheard)
        stream_go_on_from(s, now);
    s->spoken_until = 0;
    s->paused = true;
    if (s->unheard || (s->queue && s->queue->begun))
        stream_cut_face(s);
    tell(s, STREAM_PAUSED, NULL);
    stream_wake(s, 0);
}

void stream_resume(struct stream *s) {
    struct utterance *t = s->queue;
    uint64_t now = now_of(s);
    if (!s->paused)
        return;
    s->paused = false;
    if (t && t->source->ops->catch_up)
        t->source->ops->catch_up(t->source);
    if (t && t->begun) {
        stream_resume_utterance(s, now);
    } else if (s->unheard) { /* the last one was sent completely */
        stream_go_on_from(s, now);
        s->life += (double)s->unheard / 1000;
        s->played_until = s->spoken_until = now + s->unheard;
    }
    tell(s, STREAM_RESUMED, NULL);
    s->unheard = 0;
    stream_wake(s, 0);
}

void stream_rate(struct stream *s, double rate) {
    for (struct utterance *t = s->queue; t; t = t->next) {
        if (!t->source->text)
            continue;
        synthesis_set_rate(t->source->text, rate);
        if (t->started)
            utterance_respeak(t);
    }
}

int stream_jump(struct stream *s, const char *mark, struct error *e) {
    struct utterance *t = s->queue;
    size_t sentence;
    if (!t)
        return error_set(e, ERROR_NOT_SPEAKING, "nothing is being spoken");
    if (!t->source->text || !synthesis_find_mark(t->source->text, mark, &sentence)) {
        struct suggestions near = suggestions_for(mark);
        char text[SUGGESTIONS_TEXT];
        if (t->source->text)
            synthesis_near_marks(t->source->text, &near);
        return error_in_field(e, ERROR_UNKNOWN_MARK, "mark", "the utterance has no mark '%.80s'%s", mark,
                              suggestions_text(&near, text));
    }
    stream_forget_unheard(s);
    utterance_seek(t, sentence, mark);
    stream_cut_face(s);
    tell(s, STREAM_JUMPED, mark);
    return 0;
}

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
    if (t->next && t->started)    /* an utterance that could not be parsed ends before its turn */
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

static double seconds_of(const struct stream *s) {
    return (double)now_of(s) / 1000;
}

int stream_drive(struct stream *s, uint64_t driver, uint32_t voice, const struct driven_frame *frames,
                 size_t count, struct error *e) {
    if (s->drive && s->driver != driver)
        return error_plain(e, ERROR_DRIVEN);
    if (!s->drive) {
        s->drive = drive_track_new();
        s->driver = driver;
        stream_wake(s, 0);
    }
    s->driver_voice = voice;
    for (size_t i = 0; i < count; i++)
        drive_track_add(s->drive, &frames[i], seconds_of(s));
    return 0;
}

void stream_undrive(struct stream *s) {
    if (!s->drive)
        return;
    drive_track_free(s->drive);
    s->drive = NULL;
    s->driver = 0;
    stream_cut_face(s);
    stream_wake(s, 0);
}

uint64_t stream_driver(const struct stream *s) {
    return s->driver;
}

bool stream_drives_on(const struct stream *s) {
    return s->drive && seconds_of(s) - drive_track_heard(s->drive) < DRIVE_SILENCE_MAX;
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
    lexicons_free(&s->lexicons);
    drive_track_free(s->drive);
    uv_close((uv_handle_t *)s->timer, free_timer);
    free(s);
}

void stream_refuse(struct stream *s, const char *id, uint64_t command, const struct error *e) {
    struct utterance t = {.stream = s, .number = ++s->utterances, .command = command};
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

/* e: the error reported for each, or NULL. */
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

/* Applies a new seed or strength of life, also to the current utterance. */
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
