/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is spoken when: the order of a stream's utterances. Of a higher priority come before those of a lower.
 */
#include "server/base/mem.h"
#include "server/stream/stream_internal.h"
#include <stdlib.h>
#include <string.h>

/* When an utterance is spoken, as its request says. */
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

void stream_forget(struct stream *s, struct utterance **at) {
    forget(s, at, "stopped");
}

/* Of an earlier stay of that one; 0: of anybody abroad. */
static bool is_of_earlier(const struct utterance *t, uint64_t abroad) {
    return t->abroad && (!abroad || (t->abroad >> 32 == abroad >> 32 && t->abroad != abroad));
}

uint32_t stream_forget_earlier(struct stream *s, uint64_t abroad) {
    for (struct utterance **at = s->queue ? &s->queue->next : &s->queue; *at;) {
        if (is_of_earlier(*at, abroad))
            forget(s, at, (*at)->spared ? NULL : "failed");
        else
            at = &(*at)->next;
    }
    if (!s->queue || !is_of_earlier(s->queue, abroad))
        return 0;
    s->queue->spared = false;
    return s->queue->number;
}

void stream_go_alone(struct stream *s) {
    stream_forget_earlier(s, 0);
}

/* Whether it cuts what speaks. */
static bool cuts(const struct stream *s, const struct turn *turn) {
    const struct utterance *speaks = s->queue;
    return speaks && (turn->mode == SPEAK_QUEUE ? speaks->priority < turn->priority
                                                : speaks->priority <= turn->priority);
}

/* Whether a later one of the same topic makes this one needless. */
static bool is_replaced(const struct utterance *t, const struct turn *turn) {
    const struct speech_request *request = utterance_request(t);
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

/* The last that waits, where it has a lower priority than that. */
static struct utterance **last_below(struct stream *s, enum speech_priority priority) {
    struct utterance **at = s->queue ? &s->queue->next : &s->queue;
    while (*at && (*at)->next)
        at = &(*at)->next;
    return *at && (*at)->priority < priority ? at : NULL;
}

/* Whether it may come at all: -1 with *e. */
static int may_come(struct stream *s, const struct turn *turn, struct error *e) {
    if (turn->mode == SPEAK_QUIET && s->queue)
        return error_plain(e, ERROR_BUSY), -1;
    if (!s->queue || cuts(s, turn) || s->waiting - count_replaced(s, turn) < s->queue_limit ||
        last_below(s, turn->priority))
        return 0;
    return error_set(e, ERROR_QUEUE_FULL, "%u utterances wait already", s->waiting);
}

static void cut(struct stream *s) {
    stream_end_utterance(s, "stopped");
    stream_forget_unheard(s);
}

/* Puts it among the queue, in the place that its turn asks for. */
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

static struct utterance *utterance_new(struct stream *s) {
    struct utterance *t = mem_alloc(sizeof *t);
    t->stream = s;
    t->asked = uv_hrtime();
    return t;
}

uint32_t stream_speak(struct stream *s, const struct speech_request *request) {
    struct turn turn = turn_of(request);
    struct utterance *t = NULL;
    struct error e;
    if (!may_come(s, &turn, &e)) {
        t = utterance_new(s);
        t->synthesis = synthesis_open(s->pipeline, request, &utterance_callbacks, t, &e);
    }
    if (!t || !t->synthesis) {
        free(t);
        stream_refuse(s, request->id, request->order, &e);
        return 0;
    }
    t->abroad = request->abroad;
    t->order = request->order;
    t->spared = request->abroad != 0 && request->again;
    synthesis_keep(t->synthesis);
    enqueue(s, t, &turn);
    return t->number;
}

uint32_t stream_hear(struct stream *s, const struct live_request *request) {
    struct turn turn = turn_of(request->speech);
    struct utterance *t = NULL;
    struct error e;
    if (!may_come(s, &turn, &e)) {
        t = utterance_new(s);
        t->live = live_voice_open(s->pipeline, request, &utterance_callbacks, t, &e);
    }
    if (!t || !t->live) {
        free(t);
        stream_refuse(s, request->speech->id, 0, &e);
        return 0;
    }
    enqueue(s, t, &turn);
    return t->number;
}

uint32_t stream_play(struct stream *s, struct recording_source *source,
                     const struct speech_request *request) {
    struct turn turn = turn_of(request);
    struct error e;
    if (may_come(s, &turn, &e)) {
        stream_refuse(s, source->id, request->order, &e);
        recording_source_free(source);
        return 0;
    }
    struct utterance *t = utterance_new(s);
    t->recording = recording_open(s->pipeline->loop, s->pipeline->high_level, s->pipeline->reader,
                                  s->pipeline->gate, source, &utterance_callbacks, t);
    t->order = request->order;
    enqueue(s, t, &turn);
    return t->number;
}
