/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rooms that several daemons share. One daemon speaks in a room: it is the room's leader, and holds a lease
 * on it (cluster/bus.h). Any other with followers of that room is a replica of it.
 *
 * Whoever has the room claims its lease again and again: the leader to keep it, replicas to take it over. A
 * replica tells its leader that it is there, and in which ways it wants media (`here`); it is told first what
 * goes on (`recap`), then each message, once, with the bytes that the leader's own followers get (`said`),
 * and replicates together what left together; it keeps what late joiners have to be told, as the leader does.
 * What a client orders in a replica is sent to the leader (`order`), which answers (`answer`). A leader
 * without the room says so (`gone`).
 *
 * A message carries the token of the lease: it leaves only while the lease is held (the bus looks), and a
 * replica takes none but of the token that it knows as the last. A leader whose lease has run out, as it was
 * asleep, does not go on for its own followers either until it has claimed it anew.
 *
 * When the leader goes, what was spoken has ended as failed; who claims first is the next leader. Without the
 * bus each daemon speaks for its own followers; what is spoken in a leader goes on. When the bus is back, who
 * claims first is the leader; any other that is speaking may come to its end, within SPLIT_MS, and then
 * follows. */
#ifndef FACCIA_ROOMS_SHARED_SHARED_INTERNAL_H
#define FACCIA_ROOMS_SHARED_SHARED_INTERNAL_H

#include "server/access/token.h"
#include "server/cluster/bus.h"
#include "server/rooms/rooms_internal.h"
#include "server/rooms/shared/forward.h"
#include "server/rooms/shared/packet.h"

enum shared_role {
    ROLE_SEEKING, /* nobody has answered yet who speaks */
    ROLE_LEADER,  /* this daemon */
    ROLE_REPLICA, /* another one */
    ROLE_ALONE,   /* each for its own followers */
    ROLES,
};

enum {
    SPLIT_MS = 10000,       /* how long one that speaks alone may come to its end when the bus is back */
    REPLICA_MS = 3000,      /* one that says nothing for so long is gone */
    HERE_MS = 1000,         /* it says so at least so often */
    REPLICAS_MOST = 256,    /* of one room; further ones are told nothing */
    RECENT_MOST = 128,      /* more than wait in a room, as a rule */
    REPLICA_ENCODINGS = 16, /* ways in which one may want media */
    LEASE_MARGIN_MS = 200,  /* so long before its end the leader waits for the new one */
    FORWARD_MS = 4000,      /* an order is answered within that time, or not: longer than a lease */
};

/* Of a room whose leader is here. */
struct replica {
    struct replica *next;
    char name[BUS_NAME_BYTES];
    uint64_t until; /* loop time */
    uint32_t visit; /* of the replica: which it has been told for what goes on */
    struct remote_followers remote;
    struct follower all;                      /* stands for all who follow there */
    struct follower media[REPLICA_ENCODINGS]; /* in the room where media are wanted in that way */
};

struct recent {
    uint64_t number[RECENT_MOST];
    unsigned count; /* ever: the oldest make room */
};

struct shared_room {
    struct shared_rooms *all;
    struct channel *channel;
    enum shared_role role;
    char holder[BUS_NAME_BYTES]; /* who speaks; of ELSEWHERE */
    uint64_t token;              /* under which that is */
    uint64_t above;              /* the highest that was heard of */
    uint64_t heal_by;            /* loop time; of ALONE, when the bus is there */
    uint64_t kept_until;         /* loop time; 0: it is not kept */
    struct replica *replicas;
    uint64_t split;      /* the highest token before this daemon was alone: nobody goes on under it */
    struct recent past;  /* what has been told as ended here: its number, and whose (shared_daemon) */
    struct recent ended; /* the same, of whatever leader: which order had asked for it (shared_command) */
    struct recent done;  /* orders that were done here, as the leader */
    uint32_t suppressed; /* such a one, that is spoken */
    bool knew;           /* the room was followed here before that leader was found */
    bool recapped;       /* a replica has been told what goes on */
    uint32_t visit;      /* which time it follows a leader */
    uint32_t joined_mid; /* the utterance in whose middle it came to follow, until its begin is told */
    bool begin;          /* somebody waits for media that one can begin with */
    bool stale;          /* the leader knows less than is */
    uint64_t here;       /* loop time when a replica has said last that it is there */
};

struct shared_rooms {
    struct rooms *rooms;
    struct bus *bus;
    uv_timer_t *tick, *soon;
    struct forward *forwards;
    uint64_t forward_number;
    uint32_t visits; /* counted over all rooms: one that is left and entered anew is another visit, too */
};

/* leader.c */
struct shared_room *shared_find(const struct shared_rooms *all, const char *room);
uint64_t shared_now(const struct shared_rooms *all);
void shared_claim(const struct shared_room *room);

/* Sends it to one, under no lease; drops the head. */
void shared_tell(const struct shared_rooms *all, const char *to, json_t *head);

/* Which daemon sent that, and which time it follows (speech_request.h). */
uint64_t shared_origin(const struct packet *packet);

/* A daemon as a number of 31 bits, above 32 others; not 0. */
uint64_t shared_daemon(const char *name);

/* As the leader. */
void shared_send(const struct shared_room *room, const struct bus_receivers *to, const struct buf *data);

/* It is this daemon's no more, and the replicas hear of it. */
void shared_give_up(const struct shared_room *room);

/* The room stays with its leader for so long, though nobody follows: something waits there to be heard. */
void shared_keep(struct shared_room *room, uint64_t ms);

/* Why what was spoken, or ordered, is not. */
void shared_error(struct error *e);

/* forward.c */
void forwards_close(struct shared_rooms *all);
void forwards_expire(struct shared_rooms *all); /* what has waited too long is answered */
void forwards_role(struct shared_room *room);   /* those of that room, whose leader is another */
void forwards_heard(struct shared_rooms *all, const struct packet *packet);    /* one from a replica */
void forwards_answered(struct shared_rooms *all, const struct packet *packet); /* to one of this daemon's */

/* That utterance, which had been ordered here, has ended. */
void forwards_ended(struct shared_room *room, uint32_t utterance);

/* Has that utterance been ordered here, and is it to be spoken again? */
bool forwards_again(const struct shared_room *room, uint32_t utterance);

/* The leader is lost with all that was asked of it: what is to be spoken again waits for the next one (again:
 * at all), the others end. The utterance `told` (or 0) has had its end. */
void forwards_lost(struct shared_room *room, uint32_t told, bool again, const struct error *e);

/* An utterance of the leader has been told as ended here, or is asked of another: what comes of it yet is not
 * handed on. */
void shared_is_past(struct shared_room *room, uint32_t utterance);

/* replicate.c: an order among those of all daemons, by who gave it and its number there; not 0. It keeps it
 * when it is given anew to another leader. */
uint64_t shared_command(const char *asker, uint64_t number);

/* It was done here; and was it? */
void shared_note_done(struct shared_room *room, uint64_t order);
bool shared_has_done(const struct shared_room *room, uint64_t order);

/* Those who follow here have been told the end of what it asked for: they are not to hear it once more. */
bool shared_has_heard(const struct shared_room *room, uint64_t order);
void shared_note_heard(struct shared_room *room, const struct channel_item *item);
void shared_note_ended(struct shared_room *room, uint64_t order);

/* The room is here no more: nobody follows who could be told. */
void forwards_forget_room(struct shared_room *room);

void shared_set_role(struct shared_room *room, enum shared_role role);
void shared_be_alone(struct shared_room *room);

/* Something that the leader said has not been heard here: follows it anew. */
void shared_missed(struct shared_room *room);

/* The answer to a claim. */
void shared_claimed(struct shared_room *room, const char *holder, uint64_t token, uint64_t asked);

/* shared_report.c: tells the leader that the replica is there, and what it wants. */
void shared_report(struct shared_room *room);

/* replicas.c */
void replicas_report(struct shared_room *room, const struct packet *packet);
void replicas_said(const struct shared_room *room, const struct channel_item *const *items, size_t count);
void replicas_look(struct shared_room *room);
void replicas_drop(struct shared_room *room);

/* replicate.c: what the leader has said goes to those who follow here. */
void replicate(struct shared_room *room, const struct packet *packet);

/* forward.c */

struct forward {
    struct forward *prev, *next;
    struct shared_rooms *all;
    struct channel *channel; /* kept until it is taken */
    uint64_t number;
    uint64_t until; /* loop time */
    json_t *asked;
    bool sent;
    bool again;         /* what it asks for was lost once */
    uint32_t utterance; /* that the leader has taken; 0: not yet */
    unsigned tries;
    forward_done done; /* NULL: nobody waits */
    void *ctx;
};

#endif
