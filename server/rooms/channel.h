/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stream and all its followers: a client's own stream, or that of a room. Each message is encoded once
 * per requested encoding, however many followers there are. */
#ifndef FACCIA_ROOMS_CHANNEL_H
#define FACCIA_ROOMS_CHANNEL_H

#include "server/codec/media_encoder.h"
#include "server/http/message_queue.h"
#include "server/stream/stream.h"

struct rooms;
struct channel;

/* Number of followers and listeners on another daemon that one local follower represents. */
struct remote_followers {
    size_t followers, listeners;
};

/* A member of a channel. Whoever creates it owns it. */
struct follower {
    struct channel *channel;
    struct follower *next, **self;
    struct encoding encoding; /* requested media encoding */
    bool media;               /* wants media at all */
    bool lines;               /* wants lines of text instead of JSON */
    bool idle;                /* also wants idling media */
    bool watches;             /* observer, does not count as a listener */
    bool blocked; /* the browser blocks sound until the user interacts with the page, so nothing is heard */
    const struct remote_followers *remote; /* NULL: stands for itself only */
    const char *observer;                  /* name shown to other observers; NULL: not shown */
    bool overhears;                        /* wants the sound of listeners */
    bool directs;                          /* may send commands to this channel */
    bool waits;                            /* waits for media that a decoder can start with */
    bool lagging;                          /* has skipped media */
    struct message_queue *queue;           /* NULL: takes events only */
    /* Delivers messages that leave together, in order. */
    void (*deliver)(struct follower *follower, struct queued_message *const *messages, size_t count);
};

/* Creates a client's own stream. name identifies the stream in its messages. */
struct channel *channel_new(struct rooms *rooms, const char *name);

struct stream *channel_stream(const struct channel *channel);
uint64_t channel_number(const struct channel *channel); /* unique, never reused */
const char *channel_name(const struct channel *channel);
size_t channel_listeners(const struct channel *channel); /* followers, without observers */
bool channel_is_room(const struct channel *channel);
bool channel_speaks(const struct channel *channel);    /* an utterance is being spoken or waits */
bool channel_is_remote(const struct channel *channel); /* another daemon leads the room */
size_t channel_followers(const struct channel *channel);
bool channel_pending(const struct channel *channel);         /* something said is still being encoded */
struct channel *channel_next(const struct channel *channel); /* the next room in the list */

/* f->deliver must not add or remove followers. */

/* Adds a follower: sends the messages that describe the current state, then media, from the next message
 * that a decoder can start with. */
void channel_join(struct channel *channel, struct follower *follower);

/* Keeps the channel alive without followers until channel_let_go was called once for each channel_keep. */
void channel_keep(struct channel *channel);
void channel_let_go(struct channel *channel);

/* Removes a follower. Frees the channel when no follower is left and it is not kept. */
void channel_leave(struct follower *follower);

/* Turns the follower into an observer or a listener. The first listener of a room triggers the speech that
 * was held for it. */
void channel_watch(struct follower *follower, bool watches);

/* Changes the follower's encoding. */
void channel_want(struct follower *follower, const struct encoding *encoding);

/* Resumes media for a follower that has skipped some. */
void channel_resume(struct follower *follower);

/* Sets or clears (NULL) the follower's idling options. The stream idles while any follower wants it to. */
void channel_idle(struct follower *follower, const struct idle_options *options);

#endif
