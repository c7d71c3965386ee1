/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who follows a channel, and in which ways. */
#include "protocol/chunk.h"
#include "server/base/mem.h"
#include "server/net/channel_internal.h"
#include "server/net/net_internal.h"
#include <stdlib.h>

static struct variant *variant_of(struct channel *c, const struct encoding *encoding) {
    struct variant *v = c->variants;
    while (v && !encoding_same(&v->encoding, encoding))
        v = v->next;
    return v;
}

struct channel *channel_new(struct net *net, const char *name) {
    struct channel *c = mem_alloc(sizeof *c);
    c->net = net;
    c->number = ++net->channels;
    c->name = mem_strdup(name);
    c->last = &c->first;
    c->stream = stream_new(net->pipeline, &channel_sink, c, net->options.queue);
    return c;
}

static void free_channel(struct channel *c) {
    if (c->home)
        c->net->home_calls->closed(c);
    if (c->gone)
        c->gone(c);
    stream_free(c->stream);
    channel_turn_forget(c);
    channel_forget_all(c);
    catch_up_free(&c->catch_up);
    notice_board_free(&c->notices);
    for (struct variant *v = c->variants, *next; v; v = next) {
        next = v->next;
        encoder_free(v->encoder);
        free(v);
    }
    free(c->name);
    free(c);
}

static void tell_home(struct channel *c) {
    if (c->home)
        c->net->home_calls->changed(c);
}

static void begin_anew(struct channel *c, struct variant *v) {
    encoder_restart(v->encoder);
    if (c->home)
        c->net->home_calls->begin(c);
}

static void add_variant(struct channel *c, const struct encoding *encoding) {
    struct variant *v = variant_of(c, encoding);
    if (!v) {
        v = mem_alloc(sizeof *v);
        *v = (struct variant){.next = c->variants, .channel = c, .encoding = *encoding};
        const struct pipeline *pipeline = c->net->pipeline;
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
    return f->abroad ? f->abroad->listeners : !f->watches;
}

static bool is_only_listener(const struct channel *c, const struct follower *f) {
    for (const struct follower *other = c->followers; other; other = other->next)
        if (other != f && listeners_of(other))
            return false;
    return true;
}

/* For the first listener. */
static void speak_held(struct channel *c, const struct follower *f) {
    if (c->room && !c->elsewhere && !f->watches && is_only_listener(c, f))
        hold_speak(c->net, c->name, c->stream);
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

void channel_take(struct channel *c, bool elsewhere) {
    c->elsewhere = elsewhere;
    stream_idle(c->stream, c->idles && !elsewhere ? &c->idling : NULL);
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
    /* in a room, the first one's way of idling is everybody's */
    if (!others) {
        c->idles = options != NULL;
        c->idling = options ? *options : c->idling;
        if (!c->elsewhere)
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
    return c->elsewhere ? c->catch_up.begin != NULL : stream_busy(c->stream);
}

bool channel_elsewhere(const struct channel *c) {
    return c->elsewhere;
}

size_t channel_followers(const struct channel *c) {
    size_t count = 0;
    for (const struct follower *f = c->followers; f; f = f->next)
        count += f->abroad ? f->abroad->followers : 1;
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
