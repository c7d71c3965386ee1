/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the rooms share. */
#ifndef FACCIA_ROOMS_ROOMS_INTERNAL_H
#define FACCIA_ROOMS_ROOMS_INTERNAL_H

#include "server/base/metrics.h"
#include "server/rooms/channel.h"
#include "server/rooms/events.h"
#include "server/rooms/notices.h"
#include "server/rooms/rooms.h"
#include <jansson.h>

struct shared_room;

/* What was said to rooms in which nobody was, in the order in which it came. */
struct pending_speech {
    struct pending *first;
    size_t count;
};

struct rooms {
    const struct pipeline *pipeline;
    struct room_limits limits;
    rooms_run *run;
    void *ctx; /* of run */
    struct channel *list;
    unsigned count;
    uint64_t numbered;           /* channels so far */
    struct broadcast *broadcast; /* rooms that say something at the end of the loop's turn */
    struct pending_speech pending;
    const struct sharing_calls *sharing_calls; /* NULL: rooms are not shared with other daemons */
    struct shared_rooms *shared;
};

/* rooms.c: somebody has come into the room: speaks what was kept for it, by priority and in its order. */
void pending_speak(struct rooms *rooms, const char *room, struct stream *stream);

/* late_join.c */

/* Zeroed: nothing is said. Holds references to the messages. */
struct late_join {
    struct queued_message *begin, *paused; /* NULL: none */
    struct queued_message **texts; /* at most LATE_JOIN_TEXTS: the sentence, then its words and marks */
    size_t text_count, text_cap;
    uint32_t utterance; /* of begin */
    uint64_t order;     /* the same (speech_request.h) */
};

enum { LATE_JOIN_TEXTS = 512 };

/* An event of that kind was told in that message; of a beginning and an end: which utterance it is of, for
 * others may end while one is spoken; of a beginning: for which order. */
void late_join_event(struct late_join *late_join, enum stream_event_kind kind, uint32_t utterance,
                     uint64_t order, struct queued_message *message);

void late_join_tell(const struct late_join *late_join,
                    void (*tell)(void *ctx, struct queued_message *message), void *ctx);

void late_join_free(struct late_join *late_join);

/* Zeroed: nothing stands there. */
struct notice_board {
    json_t *offered;                        /* the choices, as they were told; NULL: none */
    struct queued_message *choices, *state; /* the last that was told; NULL: none */
    struct queued_message *calibration, *mood;
    json_t *asked; /* whether the listener consents, as it was told; NULL: nothing is asked */
    struct queued_message *consent;
};

/* All take a reference of their own; NULL: nothing stands there any more. */
void notice_board_choices(struct notice_board *board, struct queued_message *message, json_t *offered);
void notice_board_state(struct notice_board *board, struct queued_message *message);
void notice_board_calibration(struct notice_board *board, struct queued_message *message);
void notice_board_mood(struct notice_board *board, struct queued_message *message);
void notice_board_consent(struct notice_board *board, struct queued_message *message, json_t *asked);

void notice_board_tell(const struct notice_board *board,
                       void (*tell)(void *ctx, struct queued_message *message), void *ctx);
void notice_board_free(struct notice_board *board);

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
    bool remote;                 /* from when another daemon spoke: only those here are told */
    uint32_t utterance;          /* of a beginning or an end */
    uint64_t order;              /* the same: what asked for it (speech_request.h) */
    struct variant *variant;     /* of media, until they are ready */
    struct encoding encoding;    /* for whom media are */
    bool begin, idle;            /* of media: one can begin with them; they are those of idling */
};

enum { CHANNEL_BATCH = 32 }; /* messages that leave together */

/* What a room tells where several daemons share it (shared/shared_rooms.h). */
struct sharing_calls {
    void (*opened)(struct channel *channel);
    void (*closed)(struct channel *channel);
    void (*changed)(struct channel *channel); /* who follows, and what they want */
    void (*begin)(struct channel *channel);   /* somebody waits for media that one can begin with */
    /* The room stays with its leader for so long, though nobody follows: something waits there to be heard.
     */
    void (*keep)(struct shared_room *room, uint64_t ms);
    /* What leaves together, at most CHANNEL_BATCH; what another daemon said, too. */
    void (*said)(struct channel *channel, struct channel_item *const *items, size_t count);
};

struct channel {
    struct rooms *rooms;
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
    struct late_join late_join;
    struct notice_board notices;
    uint64_t calibrated;        /* loop time up to which its calibrations are spent: see notice_calibrate */
    struct idle_options idling; /* of those who idle */
    bool idles;
    struct shared_room *shared; /* of a room that daemons share; else NULL */
    bool remote;                /* another daemon speaks in it, and this one's stream is silent */
    uint64_t speaks_until;      /* loop time; of a shared room: then its stream waits */
};

/* channel.c: channel_say, which the channel outlasts. */
void channel_say_kept(struct channel *channel);

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

/* broadcast.c */

/* What the stream says goes to those who follow. */
extern const struct stream_sink channel_sink;

/* An encoder's answer. */
void channel_coded(void *variant, void *item, const struct encoded *encoded);

/* What another daemon has said in the room goes to those who follow here with channel_say: what left there
 * together leaves here together. Takes the item's message over. */
void channel_replicate(struct channel *channel, const struct channel_item *item);

/* All that nothing before it holds up leaves now; of a room, at the end of the loop's turn. */
void channel_say(struct channel *channel);
void channel_say_soon(struct channel *channel);

/* What speaks has come to an end for those who follow here, and a pause, too: e says why. again: it is
 * spoken again, and has a warning instead. */
void channel_cut(struct channel *channel, const struct error *e, bool again);

/* The room is spoken in here, or not any more. */
void channel_take(struct channel *channel, bool remote);

/* Tells all who follow, after what has been said. */
void channel_notice(struct channel *channel, struct queued_message *message);

/* What the variant owes will not come. */
void channel_forget_variant(struct channel *channel, struct variant *variant);
void channel_forget_all(struct channel *channel);

void broadcast_open(struct rooms *rooms, void (*say)(struct channel *channel));
void broadcast_close(struct rooms *rooms);

/* What it says at the end of the loop's turn is said. */
void broadcast_forget(struct channel *channel);

/* calibration.c: copies featurePointsCoord, textureCoord and texture of a message into another object. What a
 * head makes of them, the client says: here is checked what they must be whatever the head is. -1 with *e and
 * the field. */
int calibration_read(const json_t *message, json_t *into, struct error *e);

/* notices.c */

#endif
