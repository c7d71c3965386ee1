/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of channels share. */
#ifndef FACCIA_NET_CHANNEL_INTERNAL_H
#define FACCIA_NET_CHANNEL_INTERNAL_H

#include "server/net/catch_up.h"
#include "server/net/channel.h"
#include "server/net/notice_board.h"

/* Those who want their media in the same way. */
struct variant {
    struct variant *next;
    struct encoding encoding;
    struct encoder *encoder;
    struct channel *channel;
    unsigned followers;
    unsigned coding; /* messages that the encoder owes */
};

/* One thing that a channel says: an event, or media of a variant. */
struct channel_item {
    struct channel_item *next;
    struct queued_message *message; /* NULL: it is not known yet, or there is none */
    bool ready;                     /* it is known */
    bool media;
    bool notice;                 /* no event of the stream */
    enum stream_event_kind kind; /* of an event */
    bool elsewhere;              /* from when another daemon spoke: only those here are told */
    uint32_t utterance;          /* of a beginning or an end */
    uint64_t order;              /* the same: what asked for it (speech_request.h) */
    struct variant *variant;     /* of media, until they are ready */
    struct encoding encoding;    /* for whom media are */
    bool begin, idle;            /* of media: one can begin with them; they are those of idling */
};

enum { CHANNEL_BATCH = 32 }; /* messages that leave together */

/* What a room tells where several daemons share it (homes.h). */
struct home_calls {
    void (*opened)(struct channel *channel);
    void (*closed)(struct channel *channel);
    void (*changed)(struct channel *channel); /* who follows, and what they want */
    void (*begin)(struct channel *channel);   /* somebody waits for media that one can begin with */
    /* What leaves together, at most CHANNEL_BATCH; what another daemon said, too. */
    void (*said)(struct channel *channel, struct channel_item *const *items, size_t count);
};

struct channel {
    struct net *net;
    uint64_t number;
    char *name;
    uint32_t payer; /* who had the room made; 0: nobody who is counted */
    bool room;
    void (*gone)(struct channel *channel); /* before it is freed; may be NULL */
    struct channel *next, **self;          /* of the rooms */
    struct stream *stream;
    struct follower *followers;
    size_t follower_count;
    unsigned kept;
    bool in_turn; /* says something at the end of the loop's turn */
    struct channel *next_in_turn;
    struct variant *variants;
    struct channel_item *first, **last; /* what is said next */
    struct catch_up catch_up;
    struct notice_board notices;
    uint64_t calibrated;        /* loop time up to which its calibrations are spent: see notice_calibrate */
    struct idle_options idling; /* of those who idle */
    bool idles;
    struct home *home;     /* of a room that daemons share; else NULL */
    bool elsewhere;        /* another daemon speaks in it, and this one's stream is silent */
    uint64_t speaks_until; /* loop time; of a shared room: then its stream waits */
};

/* channel.c: channel_say, which the channel outlasts. */
void channel_say_kept(struct channel *channel);

/* channel_heard.c */

/* What will not have ended when all has been said that waits for coders. */
struct channel_heard {
    const struct queued_message *begin; /* NULL: nothing */
    uint32_t utterance;
    uint64_t order;
};

struct channel_heard channel_heard(const struct channel *channel);

/* The utterance that is heard here, 0 for none, and its order. */
uint32_t channel_utterance(const struct channel *channel);
uint64_t channel_order(const struct channel *channel);

/* Does the end of what that order asked for wait to be said? */
bool channel_is_ending(const struct channel *channel, uint64_t order);

/* Whether it says of itself that it is spoken again when it is lost. */
bool channel_is_again(const struct channel *channel);

/* channel_say.c */

/* What the stream says goes to those who follow. */
extern const struct stream_sink channel_sink;

/* An encoder's answer. */
void channel_coded(void *variant, void *item, const struct encoded *encoded);

/* What another daemon has said in the room goes to those who follow here with channel_say: what left there
 * together leaves here together. Takes the item's message over. */
void channel_hand_on(struct channel *channel, const struct channel_item *item);

/* All that nothing before it holds up leaves now; of a room, at the end of the loop's turn. */
void channel_say(struct channel *channel);
void channel_say_soon(struct channel *channel);

/* What speaks has come to an end for those who follow here, and a pause, too: e says why. again: it is
 * spoken again, and has a warning instead. */
void channel_cut(struct channel *channel, const struct error *e, bool again);

/* The room is spoken in here, or not any more. */
void channel_take(struct channel *channel, bool elsewhere);

/* Tells all who follow, after what has been said. */
void channel_notice(struct channel *channel, struct queued_message *message);

/* What the variant owes will not come. */
void channel_forget_variant(struct channel *channel, struct variant *variant);
void channel_forget_all(struct channel *channel);

/* channel_turn.c */

void channel_turn_open(struct net *net, void (*say)(struct channel *channel));
void channel_turn_close(struct net *net);

/* What it says at the end of the loop's turn is said. */
void channel_turn_add(struct channel *channel);
void channel_turn_forget(struct channel *channel);

#endif
