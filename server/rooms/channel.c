/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The followers of a channel, and the media encodings that they want. */
#include "protocol/chunk/chunk.h"
#include "server/base/mem.h"
#include "server/rooms/question.h"
#include "server/rooms/rooms_internal.h"
#include <stdlib.h>

static struct variant *variant_of(struct channel *c, const struct encoding *encoding) {
    struct variant *v = c->variants;
    while (v && !encoding_same(&v->encoding, encoding))
        v = v->next;
    return v;
}

struct channel *channel_new(struct rooms *rooms, const char *name) {
    struct channel *c = mem_alloc(sizeof *c);
    c->rooms = rooms;
    c->number = ++rooms->numbered;
    c->name = mem_strdup(name);
    c->last = &c->first;
    c->stream = stream_new(rooms->pipeline, &channel_sink, c, rooms->limits.queue);
    return c;
}

static void free_channel(struct channel *c) {
    if (c->shared)
        c->rooms->sharing_calls->closed(c);
    if (c->gone)
        c->gone(c);
    question_drop(c);
    stream_free(c->stream);
    broadcast_forget(c);
    channel_forget_all(c);
    late_join_free(&c->late_join);
    notice_board_free(&c->notices);
    channel_forget_speech(c);
    channel_end_session(c);
    queued_message_release(c->listens);
    for (struct variant *v = c->variants, *next; v; v = next) {
        next = v->next;
        encoder_free(v->encoder);
        free(v);
    }
    free(c->name);
    free(c);
}

static void tell_home(struct channel *c) {
    if (c->shared)
        c->rooms->sharing_calls->changed(c);
}

static void begin_anew(struct channel *c, struct variant *v) {
    encoder_restart(v->encoder);
    if (c->shared)
        c->rooms->sharing_calls->begin(c);
}

static void add_variant(struct channel *c, const struct encoding *encoding) {
    struct variant *v = variant_of(c, encoding);
    if (!v) {
        v = mem_alloc(sizeof *v);
        *v = (struct variant){.next = c->variants, .channel = c, .encoding = *encoding};
        const struct pipeline *pipeline = c->rooms->pipeline;
        v->encoder = encoder_new(encoding, pipeline->coders, pipeline->codec_load, channel_coded, v);
        c->variants = v;
    }
    v->followers++;
    begin_anew(c, v);
}

static void remove_variant(struct channel *c, const struct encoding *encoding) {
    struct variant **at = &c->variants;
    while (!encoding_same(&(*at)->encoding, encoding))
        at = &(*at)->next;
    struct variant *v = *at;
    if (--v->followers)
        return;
    *at = v->next;
    channel_forget_variant(c, v);
    encoder_free(v->encoder);
    free(v);
}

static void tell(void *ctx, struct queued_message *message) {
    struct follower *f = ctx;
    f->deliver(f, &message, 1);
}

static size_t listeners_of(const struct follower *f) {
    return f->remote ? f->remote->listeners : !f->watches;
}

static bool is_only_listener(const struct channel *c, const struct follower *f) {
    for (const struct follower *other = c->followers; other; other = other->next)
        if (other != f && listeners_of(other))
            return false;
    return true;
}

/* Speaks what was held for the room when its first listener joins. */
static void speak_held(struct channel *c, const struct follower *f) {
    if (c->room && !c->remote && !f->watches && is_only_listener(c, f))
        pending_speak(c->rooms, c->name, c);
}

void channel_join(struct channel *c, struct follower *f) {
    f->channel = c;
    f->next = c->followers;
    f->self = &c->followers;
    if (f->next)
        f->next->self = &f->next;
    c->followers = f;
    c->follower_count++;
    f->waits = true;
    if (f->media)
        add_variant(c, &f->encoding);
    late_join_tell(&c->late_join, tell, f);
    notice_board_tell(&c->notices, tell, f);
    speak_held(c, f);
    tell_home(c);
}

void channel_watch(struct follower *f, bool watches) {
    bool comes = f->watches && !watches;
    f->watches = watches;
    if (comes && f->channel)
        speak_held(f->channel, f);
    if (f->channel)
        tell_home(f->channel);
}

void channel_leave(struct follower *f) {
    struct channel *c = f->channel;
    if (!c)
        return;
    if (f->idle)
        channel_idle(f, NULL);
    *f->self = f->next;
    if (f->next)
        f->next->self = f->self;
    c->follower_count--;
    if (f->media)
        remove_variant(c, &f->encoding);
    f->channel = NULL;
    if (!c->followers && !c->kept)
        free_channel(c);
    else
        tell_home(c);
}

void channel_keep(struct channel *c) {
    c->kept++;
}

void channel_let_go(struct channel *c) {
    if (!--c->kept && !c->followers)
        free_channel(c);
}

void channel_say_kept(struct channel *c) {
    channel_keep(c);
    channel_say(c);
    channel_let_go(c);
}

void channel_take(struct channel *c, bool remote) {
    c->remote = remote;
    stream_undrive(c->stream); /* its driver sends to the leader alone */
    stream_idle(c->stream, c->idles && !remote ? &c->idling : NULL);
    for (struct variant *v = c->variants; v; v = v->next)
        encoder_restart(v->encoder);
}

void channel_want(struct follower *f, const struct encoding *encoding) {
    if (encoding_same(&f->encoding, encoding))
        return;
    if (f->media)
        remove_variant(f->channel, &f->encoding);
    f->encoding = *encoding;
    f->media = encoding->audio != CHUNK_AUDIO_SILENCE || encoding->fap != CHUNK_FAP_NONE;
    f->waits = true;
    if (f->media)
        add_variant(f->channel, &f->encoding);
    tell_home(f->channel);
}

void channel_resume(struct follower *f) {
    if (f->media)
        begin_anew(f->channel, variant_of(f->channel, &f->encoding));
}

void channel_idle(struct follower *f, const struct idle_options *options) {
    struct channel *c = f->channel;
    bool others = false;
    for (const struct follower *other = c->followers; other; other = other->next)
        others |= other != f && other->idle;
    f->idle = options != NULL;
    /* in a room, the options of the first follower that idles apply to all */
    if (!others) {
        c->idles = options != NULL;
        c->idling = options ? *options : c->idling;
        if (!c->remote)
            stream_idle(c->stream, options);
        tell_home(c);
    } else if (options && f->media) {
        begin_anew(c, variant_of(c, &f->encoding));
    }
}

struct stream *channel_stream(const struct channel *c) {
    return c->stream;
}

uint64_t channel_number(const struct channel *c) {
    return c->number;
}

const char *channel_name(const struct channel *c) {
    return c->name;
}

bool channel_is_room(const struct channel *c) {
    return c->room;
}

bool channel_speaks(const struct channel *c) {
    return c->remote ? c->late_join.begin != NULL : stream_busy(c->stream);
}

bool channel_is_remote(const struct channel *c) {
    return c->remote;
}

size_t channel_followers(const struct channel *c) {
    size_t count = 0;
    for (const struct follower *f = c->followers; f; f = f->next)
        count += f->remote ? f->remote->followers : 1;
    return count;
}

size_t channel_listeners(const struct channel *c) {
    size_t count = 0;
    for (const struct follower *f = c->followers; f; f = f->next)
        count += listeners_of(f);
    return count;
}

bool channel_pending(const struct channel *c) {
    return c->first;
}

static bool is_event(const struct channel_item *item, enum stream_event_kind kind) {
    return !item->media && !item->notice && item->kind == kind;
}

struct channel_heard channel_heard(const struct channel *c) {
    struct channel_heard heard = {c->late_join.begin, c->late_join.utterance, c->late_join.command};
    for (const struct channel_item *item = c->first; item; item = item->next) {
        if (is_event(item, STREAM_BEGIN))
            heard = (struct channel_heard){item->message, item->utterance, item->command};
        else if (is_event(item, STREAM_END) && item->utterance == heard.utterance)
            heard = (struct channel_heard){0};
    }
    return heard;
}

uint32_t channel_utterance(const struct channel *c) {
    return channel_heard(c).utterance;
}

uint64_t channel_command(const struct channel *c) {
    return channel_heard(c).command;
}

bool channel_is_ending(const struct channel *c, uint64_t command) {
    const struct channel_item *item = c->first;
    while (item && (!is_event(item, STREAM_END) || !item->message || item->command != command))
        item = item->next;
    return item;
}

bool channel_is_again(const struct channel *c) {
    const struct queued_message *message = channel_heard(c).begin;
    json_t *begin = message ? message_read(message) : NULL;
    bool again = json_is_true(json_object_get(begin, "again"));
    json_decref(begin);
    return again;
}
