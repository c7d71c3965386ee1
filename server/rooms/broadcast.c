/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A channel's output queue. It preserves order while encoders in other threads finish some of its items.
 * Events that begin in a chunk leave together with the chunk, and everything ready for a room within one
 * turn of the loop leaves together at the end of the turn. A daemon that keeps up has one item per turn,
 * so this adds no latency; a daemon that falls behind writes several items to each follower at once. */
#include "server/base/mem.h"
#include "server/base/work/loop_idle.h"
#include "server/rooms/question.h"
#include "server/rooms/rooms_internal.h"
#include <stdlib.h>
#include <string.h>

struct broadcast {
    struct loop_idle *end;
    struct channel *first;
    void (*say)(struct channel *channel);
};

static void say_all(void *data) {
    struct broadcast *turn = data;
    loop_idle_wait(turn->end, false);
    while (turn->first) {
        struct channel *c = turn->first;
        broadcast_forget(c);
        turn->say(c);
    }
}

static void broadcast_add(struct channel *c) {
    struct broadcast *turn = c->rooms->broadcast;
    if (c->in_turn)
        return;
    c->in_turn = true;
    c->next_in_turn = turn->first;
    turn->first = c;
    loop_idle_wait(turn->end, true);
}

void broadcast_forget(struct channel *c) {
    if (!c->in_turn)
        return;
    struct channel **at = &c->rooms->broadcast->first;
    while (*at != c)
        at = &(*at)->next_in_turn;
    *at = c->next_in_turn;
    c->in_turn = false;
}

void broadcast_open(struct rooms *rooms, void (*say)(struct channel *channel)) {
    struct broadcast *turn = mem_alloc(sizeof *turn);
    *turn = (struct broadcast){.say = say};
    turn->end = loop_idle_open(rooms->pipeline->loop, say_all, turn);
    rooms->broadcast = turn;
}

void broadcast_close(struct rooms *rooms) {
    struct broadcast *turn = rooms->broadcast;
    if (!turn)
        return;
    while (turn->first)
        broadcast_forget(turn->first);
    rooms->broadcast = NULL;
    loop_idle_close(turn->end);
    free(turn);
}

enum {
    EVENT_BYTES = 384, /* most events are shorter */
    CODING_MOST = 3,   /* chunks of a variant being encoded at a time: the lead of an utterance */
};

static struct channel_item *add(struct channel *c) {
    struct channel_item *item = mem_alloc(sizeof *item);
    item->remote = c->remote;
    *c->last = item;
    c->last = &item->next;
    return item;
}

static struct channel_item *take_first(struct channel *c) {
    struct channel_item *item = c->first;
    c->first = item->next;
    if (!c->first)
        c->last = &c->first;
    return item;
}

static void item_free(struct channel_item *item) {
    queued_message_release(item->message);
    free(item);
}

static bool wants_text(const struct follower *f, enum stream_event_kind kind) {
    return !f->media || !encoding_packs(&f->encoding, kind);
}

/* What listeners say is not for all in a room. */
static bool may_have(const struct follower *f, const struct channel_item *item) {
    const char *event = item->message->event;
    if (f->remote || !f->channel->room)
        return true;
    if (!strcmp(event, OVERHEARD))
        return f->overhears && follower_hears(f);
    return strcmp(event, HEARD) ? strcmp(event, ANSWERED) || f->directs : follower_hears(f);
}

static bool wants(struct follower *f, const struct channel_item *item) {
    if (!item->message || (item->notice && !may_have(f, item)))
        return false;
    if (!item->media)
        return item->notice || wants_text(f, item->kind);
    if (!f->media || !encoding_same(&f->encoding, &item->encoding) || (item->idle && !f->idle))
        return false;
    f->waits &= !item->begin;
    return !f->waits;
}

static void give(struct channel *c, struct channel_item **items, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!items[i]->media && !items[i]->notice)
            late_join_event(&c->late_join, items[i]->kind, items[i]->utterance, items[i]->command,
                            items[i]->message);
    if (c->shared)
        c->rooms->sharing_calls->said(c, items, count);
    for (struct follower *f = c->followers; f; f = f->next) {
        struct queued_message *messages[CHANNEL_BATCH];
        size_t wanted = 0;
        for (size_t i = 0; i < count; i++)
            if (wants(f, items[i]))
                messages[wanted++] = items[i]->message;
        if (wanted)
            f->deliver(f, messages, wanted);
    }
}

void channel_say(struct channel *c) {
    while (c->first && c->first->ready) {
        struct channel_item *items[CHANNEL_BATCH];
        size_t count = 0;
        while (c->first && c->first->ready && count < CHANNEL_BATCH)
            items[count++] = take_first(c);
        give(c, items, count);
        while (count)
            item_free(items[--count]);
    }
}

void channel_say_soon(struct channel *c) {
    if (c->room && c->rooms->broadcast)
        broadcast_add(c);
    else
        channel_say(c);
}

void channel_coded(void *ctx, void *tag, const struct encoded *encoded) {
    struct variant *v = ctx;
    struct channel_item *item = tag;
    struct metrics *metrics = v->channel->rooms->pipeline->metrics;
    metrics_add(metrics, METRIC_AUDIO_BYTES, (double)encoded->audio_bytes);
    metrics_add(metrics, METRIC_FAP_BYTES, (double)encoded->fap_bytes);
    v->coding--;
    item->variant = NULL;
    item->ready = true;
    item->begin = encoded->begin;
    if (encoded->size) {
        item->message = queued_message_new(WEBSOCKET_BINARY, encoded->data, encoded->size);
        item->message->born = uv_now(v->channel->rooms->pipeline->loop);
    }
    channel_say_soon(v->channel);
}

static struct channel_item *add_media(struct channel *c, struct variant *v, bool idle) {
    struct channel_item *item = add(c);
    item->media = true;
    item->variant = v;
    item->encoding = v->encoding;
    item->idle = idle;
    v->coding++;
    return item;
}

void channel_forget_variant(struct channel *c, struct variant *v) {
    for (struct channel_item *item = c->first; item; item = item->next)
        if (item->variant == v) {
            item->variant = NULL;
            item->ready = true;
        }
    channel_say(c);
}

void channel_forget_all(struct channel *c) {
    while (c->first)
        item_free(take_first(c));
}

/* Returns whether events need a line of text; in a room always, since a client that joins later may want
 * lines. */
static bool is_typed(const struct channel *c) {
    bool lines = c->room;
    for (const struct follower *f = c->followers; f && !lines; f = f->next)
        lines = f->lines;
    return lines;
}

static struct queued_message *line_of(const struct stream_event *event) {
    struct buf line = {0};
    event_line(&line, event);
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, line.data, line.size);
    buf_free(&line);
    return message;
}

/* Returns whether the event is sent as text; in a room always, since a client that joins later may need
 * it. */
static bool is_text(const struct channel *c, enum stream_event_kind kind) {
    bool text = c->room;
    for (const struct follower *f = c->followers; f && !text; f = f->next)
        text = wants_text(f, kind);
    return text;
}

static void record(const struct channel *c, const struct buf *text) {
    json_t *event = json_loadb((const char *)text->data, text->size, 0, NULL);
    session_event(c->session, event);
    json_decref(event);
}

static void add_event(struct channel *c, const struct stream_event *event) {
    struct buf text = {0};
    buf_reserve(&text, EVENT_BYTES);
    event_write(&text, event, c->name);
    struct channel_item *item = add(c);
    item->kind = event->kind;
    item->utterance = event->utterance;
    item->command = event->command;
    item->ready = true;
    item->message = queued_message_new(WEBSOCKET_TEXT, text.data, text.size);
    item->message->event = event_name(event->kind);
    item->message->line = is_typed(c) ? line_of(event) : NULL;
    if (c->session)
        record(c, &text);
    buf_free(&text);
}

/* Ends the utterance in the late-join state without a message to followers. */
static void add_end(struct channel *c, uint32_t utterance) {
    struct channel_item *item = add(c);
    item->kind = STREAM_END;
    item->utterance = utterance;
    item->ready = true;
}

void channel_notice(struct channel *c, struct queued_message *message) {
    struct channel_item *item = add(c);
    item->notice = item->ready = true;
    item->message = message;
    message->refs++;
    channel_say(c);
}

void channel_replicate(struct channel *c, const struct channel_item *said) {
    struct channel_item *item = add(c);
    *item = *said;
    item->next = NULL;
    item->remote = true;
    item->ready = true;
}

/* Returns whether the event begins in a chunk; the chunk follows at once, so the event waits for it. */
static bool is_of_chunk(enum stream_event_kind kind) {
    return kind == STREAM_BEGIN || kind == STREAM_SENTENCE || kind == STREAM_SPEAKER || kind == STREAM_WORD ||
           kind == STREAM_MARK || kind == STREAM_PHONE;
}

/* Returns whether there are local listeners, and no listener, local or remote, can hear: the sound of all
 * of them is blocked. */
static bool is_blocked(const struct channel *c) {
    bool blocked = false;
    for (const struct follower *f = c->followers; f; f = f->next) {
        if (f->remote ? f->remote->listeners : !f->watches && !f->blocked)
            return false;
        blocked = blocked || (!f->remote && !f->watches);
    }
    return blocked;
}

/* Marks the end of an utterance in a room when no listener can have heard it. */
static const struct stream_event *with_blocked(const struct channel *c, const struct stream_event *event,
                                               struct stream_event *end) {
    *end = *event;
    end->blocked = is_blocked(c);
    return end;
}

static void on_event(void *ctx, const struct stream_event *event) {
    struct channel *c = ctx;
    struct stream_event end;
    for (struct variant *v = c->variants; v && event->kind == STREAM_END; v = v->next)
        encoder_end(v->encoder, event->reason && !strcmp(event->reason, "done"), add_media(c, v, false));
    for (struct variant *v = c->variants; v; v = v->next)
        if (encoding_packs(&v->encoding, event->kind))
            encoder_event(v->encoder, event);
    if (event->kind == STREAM_END && !event->reason)
        add_end(c, event->utterance);
    else if (is_text(c, event->kind))
        add_event(c, event->kind == STREAM_END && c->room ? with_blocked(c, event, &end) : event);
    if (!is_of_chunk(event->kind))
        channel_say(c);
    if (event->kind == STREAM_END)
        question_spoken(c, event->utterance, event->reason);
}

/* Builds the end from the begin message, and the duration from the last word or mark. */
void channel_cut(struct channel *c, const struct error *e, bool again) {
    const struct late_join *up = &c->late_join;
    struct stream_event event = {.error = e, .idle = -1};
    const struct channel_heard heard = channel_heard(c);
    json_t *begin = heard.begin ? message_read(heard.begin) : NULL;
    json_t *last = up->text_count ? message_read(up->texts[up->text_count - 1]) : NULL;
    if (begin) {
        event.utterance = heard.utterance;
        event.command = heard.command;
        event.id = json_string_value(json_object_get(begin, "id"));
        event.sample_rate = (uint32_t)json_integer_value(json_object_get(begin, "rate"));
        event.duration = (uint32_t)json_integer_value(json_object_get(last, "sample"));
        event.kind = again ? STREAM_WARNING : STREAM_ERROR;
        on_event(c, &event);
        event.kind = STREAM_END;
        event.reason = again ? NULL : "failed";
        on_event(c, &event);
    }
    if (up->paused)
        on_event(c, &(struct stream_event){.kind = STREAM_RESUMED, .idle = -1});
    json_decref(begin);
    json_decref(last);
}

static void on_media(void *ctx, const struct media *media) {
    struct channel *c = ctx;
    metrics_add(c->rooms->pipeline->metrics, METRIC_CHUNKS, 1);
    for (struct variant *v = c->variants; v; v = v->next)
        encoder_media(v->encoder, media, add_media(c, v, !media->utterance));
    channel_say(c);
}

/* A client's own stream waits for its listener; a room waits for no follower. Both wait for the encoders. */
static bool on_ready(void *ctx) {
    const struct channel *c = ctx;
    const struct follower *f = c->followers;
    if (c->shared && (c->remote || uv_now(c->rooms->pipeline->loop) >= c->speaks_until))
        return false;
    for (const struct variant *v = c->variants; v; v = v->next)
        if (v->coding >= CODING_MOST)
            return false;
    return c->room || !f || !f->queue || f->queue->unsent < c->rooms->limits.send_bytes;
}

const struct stream_sink channel_sink = {on_event, on_media, on_ready};
