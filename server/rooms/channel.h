/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stream and all who follow it: one's own, or that of a room. What it says is written once for each way in
 * which somebody wants to have it, however many follow. */
#ifndef FACCIA_ROOMS_CHANNEL_H
#define FACCIA_ROOMS_CHANNEL_H

#include "server/codec/media_encoder.h"
#include "server/http/message_queue.h"
#include "server/stream/stream.h"

struct rooms;
struct channel;

/* Those of another daemon whom one follower stands for. */
struct remote_followers {
    size_t followers, listeners;
};

/* A member of a channel. Its maker owns it. */
struct follower {
    struct channel *channel;
    struct follower *next, **self;
    struct encoding encoding; /* how media are wanted */
    bool media;               /* are wanted at all */
    bool lines;               /* instead of JSON */
    bool idle;                /* also those of idling */
    bool watches;             /* looks on: is no listener */
    bool blocked;             /* its browser plays no sound until somebody touches it: it hears nothing */
    const struct remote_followers *remote; /* NULL: it stands for itself */
    const char *observer;                  /* what others who look on know it by; NULL: nothing */
    bool directs;                          /* it may say something here */
    bool waits;                            /* for media that one can begin with */
    bool lagging;                          /* has left out media */
    struct message_queue *queue;           /* NULL for one that takes events alone */
    /* Messages that leave together, in this order. */
    void (*deliver)(struct follower *follower, struct queued_message *const *messages, size_t count);
};

/* A stream of one's own. name is what its messages are marked with. */
struct channel *channel_new(struct rooms *rooms, const char *name);

struct stream *channel_stream(const struct channel *channel);
uint64_t channel_number(const struct channel *channel); /* no other has had it */
const char *channel_name(const struct channel *channel);
size_t channel_listeners(const struct channel *channel); /* followers that do not just look on */
bool channel_is_room(const struct channel *channel);
bool channel_speaks(const struct channel *channel); /* something is spoken in it, or waits */
bool channel_is_remote(
    const struct channel *channel); /* a room in which another daemon speaks (shared/shared_rooms.h) */
size_t channel_followers(const struct channel *channel);
bool channel_pending(const struct channel *channel); /* something that was said is still being coded */
struct channel *channel_next(const struct channel *channel); /* of the rooms */

/* What f->deliver does must not let anybody in or out. */

/* Lets him in: he gets what is going on now, as far as it has been said in messages, and media from the next
 * ones on with which one can begin. */
void channel_join(struct channel *channel, struct follower *follower);

/* The channel stays, though nobody follows, until it is let go as often as it was kept. */
void channel_keep(struct channel *channel);
void channel_let_go(struct channel *channel);

/* Frees the channel when nobody is left. */
void channel_leave(struct follower *follower);

/* He only looks on from now on, or listens: who comes to listen hears what was kept for the room. */
void channel_watch(struct follower *follower, bool watches);

/* He wants the media otherwise from now on. */
void channel_want(struct follower *follower, const struct encoding *encoding);

/* He can take media again after he has left some out. */
void channel_resume(struct follower *follower);

/* Idles while anybody in it wants that. */
void channel_idle(struct follower *follower, const struct idle_options *options);

#endif
