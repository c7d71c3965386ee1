/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/channel.h"
#include "server/base/mem.h"
#include "server/net/catch_up.h"
#include "server/net/net_internal.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Those who want their media in the same way. */
struct variant {
    struct variant *next;
    struct encoding encoding;
    struct encoder *encoder;
    unsigned followers;
};

enum { EVENT_BYTES = 384 }; /* most events have fewer */

struct channel {
    struct net *net;
    char *name;
    bool room;
    struct channel *next, **self; /* of the rooms */
    struct stream *stream;
    struct follower *followers;
    size_t follower_count;
    struct variant *variants;
    struct catch_up catch_up;
};

static struct variant *variant_of(struct channel *c, const struct encoding *encoding) {
    struct variant *v = c->variants;
    while (v && !encoding_same(&v->encoding, encoding))
        v = v->next;
    return v;
}

static bool wants_text(const struct follower *f, enum stream_event_kind kind) {
    return !f->media || !encoding_packs(&f->encoding, kind);
}

/* Those who come later to a room are told as text, too. */
static bool is_text(const struct channel *c, enum stream_event_kind kind) {
    bool text = c->room;
    for (const struct follower *f = c->followers; f && !text; f = f->next)
        text = wants_text(f, kind);
    return text;
}

static void deliver_media(struct channel *c, const struct variant *v, const struct buf *bytes, bool start,
                          bool idle) {
    if (!bytes->size)
        return;
    struct queued_message *message = queued_message_new(WEBSOCKET_BINARY, bytes->data, bytes->size);
    message->born = uv_now(c->net->pipeline->loop);
    for (struct follower *f = c->followers; f; f = f->next) {
        if (!f->media || !encoding_same(&f->encoding, &v->encoding) || (idle && !f->idle))
            continue;
        f->waits &= !start;
        if (!f->waits)
            f->deliver(f, message);
    }
    queued_message_release(message);
}

/* The ends of the audio, which the coders still hold. */
static void end_media(struct channel *c, bool heard) {
    for (struct variant *v = c->variants; v; v = v->next) {
        struct buf bytes = {0};
        encoder_end(v->encoder, heard, &bytes);
        deliver_media(c, v, &bytes, false, false);
        buf_free(&bytes);
    }
}

static void on_event(void *ctx, const struct stream_event *event) {
    struct channel *c = ctx;
    struct buf text = {0};
    if (event->kind == STREAM_END)
        end_media(c, !strcmp(event->reason, "done"));
    for (struct variant *v = c->variants; v; v = v->next)
        if (encoding_packs(&v->encoding, event->kind))
            encoder_event(v->encoder, event);
    if (!is_text(c, event->kind))
        return;
    buf_reserve(&text, EVENT_BYTES);
    event_write(&text, event, c->name);
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, text.data, text.size);
    message->event = event_name(event->kind);
    catch_up_event(&c->catch_up, event->kind, message);
    for (struct follower *f = c->followers; f; f = f->next)
        if (wants_text(f, event->kind))
            f->deliver(f, message);
    queued_message_release(message);
    buf_free(&text);
}

static void on_media(void *ctx, const struct chunk *chunk, const struct fap_frame *frames) {
    struct channel *c = ctx;
    struct metrics *metrics = c->net->pipeline->metrics;
    metrics_add(metrics, METRIC_CHUNKS, 1);
    for (struct variant *v = c->variants; v; v = v->next) {
        struct buf bytes = {0};
        struct encoded coded = encoder_chunk(v->encoder, chunk, frames, &bytes);
        metrics_add(metrics, METRIC_AUDIO_BYTES, (double)coded.audio_bytes);
        metrics_add(metrics, METRIC_FAP_BYTES, (double)coded.fap_bytes);
        deliver_media(c, v, &bytes, coded.begin, !chunk->utterance);
        buf_free(&bytes);
    }
}

/* A stream of one's own waits for its listener; a room waits for nobody. */
static bool on_ready(void *ctx) {
    const struct channel *c = ctx;
    const struct follower *f = c->followers;
    return c->room || !f || !f->queue || f->queue->unsent < c->net->options.send_bytes;
}

struct channel *channel_new(struct net *net, const char *name) {
    static const struct stream_sink sink = {on_event, on_media, on_ready};
    struct channel *c = mem_alloc(sizeof *c);
    c->net = net;
    c->name = mem_strdup(name);
    c->stream = stream_new(net->pipeline, &sink, c, net->options.queue);
    return c;
}

struct channel *channel_find(const struct net *net, const char *name) {
    struct channel *c = net->rooms;
    while (c && strcmp(c->name, name))
        c = c->next;
    return c;
}

static bool is_name(const char *name) {
    size_t length = strlen(name);
    for (const char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c))
            return false;
    return length > 0 && length <= TOKEN_ROOM;
}

int channel_check_name(const char *name, struct error *e) {
    return is_name(name) ? 0
                         : error_in_field(e, ERROR_BAD_FIELD, "room",
                                          "must have 1 to %d letters, digits, and any of - _ .", TOKEN_ROOM);
}

struct channel *channel_room(struct net *net, const char *name, struct error *e) {
    struct channel *c = channel_find(net, name);
    if (c)
        return c;
    if (channel_check_name(name, e))
        return NULL;
    if (net->room_count >= net->options.rooms) {
        error_set(e, ERROR_TOO_MANY_ROOMS, "there are %u rooms already", net->room_count);
        return NULL;
    }
    c = channel_new(net, name);
    c->room = true;
    c->next = net->rooms;
    c->self = &net->rooms;
    if (c->next)
        c->next->self = &c->next;
    net->rooms = c;
    net->room_count++;
    metrics_add(net->pipeline->metrics, METRIC_ROOMS, 1);
    return c;
}

static void free_channel(struct channel *c) {
    if (c->room) {
        *c->self = c->next;
        if (c->next)
            c->next->self = c->self;
        c->net->room_count--;
        metrics_add(c->net->pipeline->metrics, METRIC_ROOMS, -1);
    }
    stream_free(c->stream);
    catch_up_free(&c->catch_up);
    for (struct variant *v = c->variants, *next; v; v = next) {
        next = v->next;
        encoder_free(v->encoder);
        free(v);
    }
    free(c->name);
    free(c);
}

static void add_variant(struct channel *c, const struct encoding *encoding) {
    struct variant *v = variant_of(c, encoding);
    if (!v) {
        v = mem_alloc(sizeof *v);
        *v = (struct variant){.next = c->variants,
                              .encoding = *encoding,
                              .encoder = encoder_new(encoding, c->net->pipeline->codec_load)};
        c->variants = v;
    }
    v->followers++;
    encoder_restart(v->encoder);
}

static void remove_variant(struct channel *c, const struct encoding *encoding) {
    struct variant **at = &c->variants;
    while (!encoding_same(&(*at)->encoding, encoding))
        at = &(*at)->next;
    struct variant *v = *at;
    if (--v->followers)
        return;
    *at = v->next;
    encoder_free(v->encoder);
    free(v);
}

static void tell(void *ctx, struct queued_message *message) {
    struct follower *f = ctx;
    f->deliver(f, message);
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
    catch_up_tell(&c->catch_up, tell, f);
    if (c->room && c->follower_count == 1)
        hold_speak(c->net, c);
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
    if (!c->followers)
        free_channel(c);
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
}

void channel_resume(struct follower *f) {
    if (f->media)
        encoder_restart(variant_of(f->channel, &f->encoding)->encoder);
}

void channel_idle(struct follower *f, const struct idle_options *options) {
    struct channel *c = f->channel;
    bool others = false;
    for (const struct follower *other = c->followers; other; other = other->next)
        others |= other != f && other->idle;
    f->idle = options != NULL;
    /* in a room, the first one's way of idling is everybody's */
    if (!others)
        stream_idle(c->stream, options);
    else if (options && f->media)
        encoder_restart(variant_of(c, &f->encoding)->encoder);
}

struct stream *channel_stream(const struct channel *c) {
    return c->stream;
}

const char *channel_name(const struct channel *c) {
    return c->name;
}

bool channel_is_room(const struct channel *c) {
    return c->room;
}

size_t channel_followers(const struct channel *c) {
    return c->follower_count;
}

struct channel *channel_next(const struct channel *c) {
    return c->next;
}
