/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internal declarations shared by the files of the rooms. */
#ifndef FACCIA_ROOMS_ROOMS_INTERNAL_H
#define FACCIA_ROOMS_ROOMS_INTERNAL_H

#include "server/base/metrics.h"
#include "server/rooms/channel.h"
#include "server/rooms/events.h"
#include "server/rooms/notices.h"
#include "server/rooms/repeat.h"
#include "server/rooms/rooms.h"
#include "server/rooms/session.h"
#include <jansson.h>

struct question;
struct shared_room;

/* notices.c: sends the notice, and returns its message for the board. */
struct queued_message *notice_tell(struct channel *channel, const json_t *told, const char *event);

/* Checks a list of choices. -1 with *e "bad-field". */
int notice_check_choices(const json_t *choices, struct error *e);

/* Speech held for empty rooms, in the order of arrival. */
struct pending_speech {
    struct pending *first;
    size_t count;
};

struct rooms {
    const struct pipeline *pipeline;
    struct room_limits limits;
    rooms_run *run;
    void *ctx;            /* passed to run */
    const char *sessions; /* folder for the sessions of studies; NULL: not recorded */
    struct channel *list;
    unsigned count;
    uint64_t numbered;           /* channels created so far */
    struct broadcast *broadcast; /* rooms to flush at the end of the loop's turn */
    struct pending_speech pending;
    const struct sharing_calls *sharing_calls; /* NULL: rooms are not shared with other daemons */
    struct shared_rooms *shared;
};

/* rooms.c: speaks what was held for the room, now that it has a listener: by priority, then in order of
 * arrival. */
void pending_speak(struct rooms *rooms, const char *room, struct channel *channel);

/* late_join.c */

/* The messages that describe the utterance in progress to late joiners. All zero: nothing is being spoken.
 * Holds references to the messages. */
struct late_join {
    struct queued_message *begin, *paused; /* NULL: none */
    struct queued_message **texts; /* at most LATE_JOIN_TEXTS: the sentence, then its words and marks */
    size_t text_count, text_cap;
    uint32_t utterance; /* utterance of begin, 0: none */
    uint64_t command;   /* command that caused it (speech_request.h) */
};

enum { LATE_JOIN_TEXTS = 512 };

/* Records an event of the stream and its message. utterance: only for begin and end, since another
 * utterance may end during one. command: only for begin, the command that caused the utterance. */
void late_join_event(struct late_join *late_join, enum stream_event_kind kind, uint32_t utterance,
                     uint64_t command, struct queued_message *message);

void late_join_tell(const struct late_join *late_join,
                    void (*tell)(void *ctx, struct queued_message *message), void *ctx);

void late_join_free(struct late_join *late_join);

/* The current notices. All zero: none. */
struct notice_board {
    json_t *offered;                        /* the current choices, as sent; NULL: none */
    struct queued_message *choices, *state; /* last message sent; NULL: none */
    struct queued_message *calibration, *mood, *lexicon, *backdrop, *head, *driven;
    json_t *asked; /* the current consent question or answer, as sent; NULL: none */
    struct queued_message *consent;
};

/* Each function takes its own reference; NULL removes the notice. */
void notice_board_choices(struct notice_board *board, struct queued_message *message, json_t *offered);
void notice_board_state(struct notice_board *board, struct queued_message *message);
void notice_board_calibration(struct notice_board *board, struct queued_message *message);
void notice_board_mood(struct notice_board *board, struct queued_message *message);
void notice_board_backdrop(struct notice_board *board, struct queued_message *message);
void notice_board_lexicon(struct notice_board *board, struct queued_message *message);
void notice_board_head(struct notice_board *board, struct queued_message *message);
void notice_board_driven(struct notice_board *board, struct queued_message *message);
void notice_board_consent(struct notice_board *board, struct queued_message *message, json_t *asked);

void notice_board_tell(const struct notice_board *board,
                       void (*tell)(void *ctx, struct queued_message *message), void *ctx);
void notice_board_free(struct notice_board *board);

/* The event of a notice that only some followers get (follower_hears). */
#define HEARD "heard"

/* The same for those of them who want to hear the sound. */
#define OVERHEARD "overheard"

/* The event of a notice that only followers with the right to direct the room get. */
#define ANSWERED "answered"

/* The followers that want the same media encoding. */
struct variant {
    struct variant *next;
    struct encoding encoding;
    struct encoder *encoder;
    struct channel *channel;
    unsigned followers;
    unsigned coding; /* messages that the encoder has not delivered yet */
};

/* One entry of a channel's output: an event, a notice, or media of a variant. */
struct channel_item {
    struct channel_item *next;
    struct queued_message *message; /* NULL: not known yet, or nothing to send */
    bool ready;                     /* message is final */
    bool media;
    bool notice;                 /* not an event of the stream */
    enum stream_event_kind kind; /* of an event */
    bool remote;                 /* created while another daemon led the room: sent to local followers only */
    uint32_t utterance;          /* of a begin or an end */
    uint64_t command;            /* of a begin or an end: the command that caused it (speech_request.h) */
    struct variant *variant;     /* of media, until they are ready */
    struct encoding encoding;    /* of media: the encoding that they are in */
    bool begin, idle;            /* of media: a decoder can start with them; they are idling media */
};

enum { CHANNEL_BATCH = 32 }; /* most messages that leave together */

/* Callbacks of a room into the sharing code (shared/shared_internal.h). */
struct sharing_calls {
    void (*opened)(struct channel *channel);
    void (*closed)(struct channel *channel);
    void (*changed)(struct channel *channel); /* followers, or what they want, changed */
    void (*begin)(struct channel *channel);   /* a follower waits for media that a decoder can start with */
    /* Keeps the room with its leader for ms, even without followers: held speech waits there for a
     * listener. */
    void (*keep)(struct shared_room *room, uint64_t ms);
    /* Passes on items that leave together, at most CHANNEL_BATCH, including items that another daemon
     * said. */
    void (*said)(struct channel *channel, struct channel_item *const *items, size_t count);
};

struct channel {
    struct rooms *rooms;
    uint64_t number;
    char *name;
    uint32_t quota_key; /* who created the room; 0: not counted */
    bool room;
    void (*gone)(struct channel *channel); /* called before the channel is freed; may be NULL */
    struct channel *next, **self;          /* list of rooms */
    struct stream *stream;
    struct follower *followers;
    size_t follower_count;
    unsigned kept;
    bool in_turn; /* to be flushed at the end of the loop's turn */
    struct channel *next_in_turn;
    struct variant *variants;
    struct question *question;          /* waits for its answer; NULL: none */
    unsigned listening;                 /* utterances of listeners being heard */
    struct queued_message *listens;     /* the state told with the first of them; NULL: none */
    struct manner manner;               /* of all that is spoken */
    struct speech_request *said;        /* the last text, to be said again; NULL: none */
    uint32_t said_as;                   /* its utterance */
    struct session *session;            /* being recorded; NULL: none */
    struct session *recorded;           /* the last one, ended, until another begins; NULL: none */
    struct channel_item *first, **last; /* output queue, oldest first */
    struct late_join late_join;
    struct notice_board notices;
    uint64_t calibrated; /* loop time up to which the calibration budget is spent: see notice_calibrate */
    struct idle_options idling; /* options in effect */
    bool idles;
    struct shared_room *shared; /* NULL: the room is not shared */
    bool remote;                /* another daemon leads the room, and this daemon's stream is silent */
    uint64_t speaks_until;      /* loop time at which the stream of a shared room must wait for its lease */
};

/* notices.c: completes the files of a session. */
void channel_end_session(struct channel *channel);

/* repeat.c: drops the copy of the last text. */
void channel_forget_speech(struct channel *channel);

/* channel.c: channel_say on a channel that is kept alive meanwhile. */
void channel_say_kept(struct channel *channel);

/* The utterance that will still be in progress once everything in the output queue has been sent. */
struct channel_heard {
    const struct queued_message *begin; /* NULL: none */
    uint32_t utterance;
    uint64_t command;
};

struct channel_heard channel_heard(const struct channel *channel);

/* The utterance that followers hear, 0 for none, and the command that caused it. */
uint32_t channel_utterance(const struct channel *channel);
uint64_t channel_command(const struct channel *channel);

/* Returns whether the end of the command's utterance is still in the output queue. */
bool channel_is_ending(const struct channel *channel, uint64_t command);

/* Returns whether the utterance in progress is marked to be spoken again when its daemon is lost. */
bool channel_is_again(const struct channel *channel);

/* broadcast.c */

/* Sends the stream's output to the channel's followers. */
extern const struct stream_sink channel_sink;

/* The encoder's callback: its output for one item. */
void channel_coded(void *variant, void *item, const struct encoded *encoded);

/* Queues an item that another daemon said in the room; channel_say sends it. Items that left the leader
 * together leave here together. Takes ownership of the item's message. */
void channel_replicate(struct channel *channel, const struct channel_item *item);

/* channel_say sends every item that is not behind an unfinished one. channel_say_soon does so at the end
 * of the loop's turn for a room, otherwise at once. */
void channel_say(struct channel *channel);
void channel_say_soon(struct channel *channel);

/* Ends the utterance in progress, and a pause, for local followers; e says why. again: it will be spoken
 * again, so followers get a warning instead of an error. */
void channel_cut(struct channel *channel, const struct error *e, bool again);

/* Hands the stream over when this daemon becomes a replica of the room (remote), or no longer is one. */
void channel_take(struct channel *channel, bool remote);

/* Sends a notice to all followers, after everything already queued. */
void channel_notice(struct channel *channel, struct queued_message *message);

/* Stops waiting for the variant's pending messages. */
void channel_forget_variant(struct channel *channel, struct variant *variant);
void channel_forget_all(struct channel *channel);

void broadcast_open(struct rooms *rooms, void (*say)(struct channel *channel));
void broadcast_close(struct rooms *rooms);

/* Cancels the flush at the end of the loop's turn. */
void broadcast_forget(struct channel *channel);

/* calibration.c: copies featurePointsCoord, textureCoord and texture of a message into another object.
 * Checks only what must hold for every head; how a head applies them is up to the client. Returns -1 with
 * *e and the field. */
int calibration_read(const json_t *message, json_t *into, struct error *e);

#endif
