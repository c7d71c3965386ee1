/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of a room that several daemons serve: its leader, its replicas, and what they send. */
#ifndef FACCIA_ROOMS_SHARED_SHARED_INTERNAL_H
#define FACCIA_ROOMS_SHARED_SHARED_INTERNAL_H

#include "server/access/token.h"
#include "server/base/buf.h"
#include "server/cluster/cluster.h"
#include "server/rooms/rooms_internal.h"
#include "server/rooms/shared/forward.h"

#include <jansson.h>
#include <stdbool.h>

/* Packets between daemons: a line of JSON (the head), then bytes (the body). */

/* Packets of another version are ignored. */
enum { PACKET_VERSION = 5 };

struct packet {
    json_t *head;
    const char *kind, *room, *from; /* borrowed from the head; "" if missing */
    const uint8_t *body;            /* points into the data that was read */
    size_t size;
};

/* Creates the head of a packet about the room; the caller adds members. */
json_t *packet_begin(const char *kind, const char *room);

/* Appends the packet to out; releases the head. */
void packet_write(struct buf *out, json_t *head, const void *body, size_t size);

/* Parses a packet. Returns false when it is malformed or of another version. The caller releases the head. */
bool packet_read(const void *data, size_t size, struct packet *packet);

/* Returns a non-negative integer of the head; 0 if missing. */
uint64_t packet_number(const struct packet *packet, const char *name);

enum shared_role {
    ROLE_SEEKING, /* no leader is known yet */
    ROLE_LEADER,  /* this daemon leads */
    ROLE_REPLICA, /* another daemon leads */
    ROLE_ALONE,   /* no bus: each daemon serves its own followers */
    ROLES,
};

enum {
    SPLIT_MS = 10000,    /* when the bus is back: time for a daemon that is alone to finish its utterance */
    REPLICA_MS = 3000,   /* a silent replica is dropped after this time */
    HERE_MS = 1000,      /* longest interval between a replica's reports */
    REPLICAS_MOST = 256, /* of one room; further ones are ignored */
    RECENT_MOST = 128,   /* usually more than can wait in a room */
    REPLICA_ENCODINGS = 16, /* most encodings that one replica may request */
    LEASE_MARGIN_MS = 200,  /* the leader stops this long before its lease ends, unless it was renewed */
    FORWARD_MS = 4000,      /* timeout of a forwarded command: longer than a lease */
};

/* A replica of a room that this daemon leads. */
struct replica {
    struct replica *next;
    char name[BUS_NAME_BYTES];
    uint64_t until; /* loop time at which it is dropped */
    uint32_t visit; /* session of the replica that was last sent a recap */
    struct remote_followers remote;
    struct follower all;                      /* stands for all followers there */
    struct follower media[REPLICA_ENCODINGS]; /* one per requested encoding */
};

struct recent {
    uint64_t number[RECENT_MOST];
    unsigned count; /* entries added so far; new ones overwrite the oldest */
};

struct shared_room {
    struct shared_rooms *all;
    struct channel *channel;
    enum shared_role role;
    char holder[BUS_NAME_BYTES]; /* name of the leader while ROLE_REPLICA */
    uint64_t token;              /* of the leader's lease */
    uint64_t above;              /* highest token seen */
    uint64_t heal_by;            /* loop time; while ROLE_ALONE with the bus back: end of SPLIT_MS */
    uint64_t kept_until;         /* loop time; 0: not kept */
    struct replica *replicas;
    uint64_t split;     /* highest token from before this daemon was alone: it must not lead under it again */
    struct recent past; /* utterances already ended here: leader (shared_daemon) and number */
    struct recent ended; /* commands whose end was sent here, under any leader (shared_command) */
    struct recent done;  /* commands run here as the leader */
    uint32_t suppressed; /* utterance in progress that has already ended here: not passed on; 0: none */
    bool knew;           /* the room was already followed here before this leader was found */
    bool recapped;       /* as a replica: the leader's recap has arrived */
    uint32_t visit;      /* number of the session with the present leader */
    uint32_t joined_mid; /* utterance in progress when this daemon joined, until its begin arrives; 0: none */
    bool begin;          /* a follower waits for media that a decoder can start with */
    bool stale;          /* something changed since the last report to the leader */
    uint64_t here;       /* loop time of the last report to the leader */
};

struct shared_rooms {
    struct rooms *rooms;
    struct bus *bus;
    uv_timer_t *tick, *soon;
    struct forward *forwards;
    uint64_t forward_number;
    uint32_t visits; /* sessions so far, in all rooms; joining a room again starts one */
};

/* leader.c */
struct shared_room *shared_find(const struct shared_rooms *all, const char *room);
uint64_t shared_now(const struct shared_rooms *all);
void shared_claim(const struct shared_room *room);

/* Sends the head to one daemon, under no lease; releases the head. */
void shared_tell(const struct shared_rooms *all, const char *to, json_t *head);

/* The daemon that sent the packet and its session number (speech_request.h). */
uint64_t shared_origin(const struct packet *packet);

/* A daemon's name as a 31-bit number, in the upper half of the result; never 0. */
uint64_t shared_daemon(const char *name);

/* Sends data under the room's lease, as the leader. */
void shared_send(const struct shared_room *room, const struct bus_receivers *to, const struct buf *data);

/* Releases the lease and tells the replicas. */
void shared_give_up(const struct shared_room *room);

/* Keeps the room with its leader for ms, even without followers: held speech waits there for a listener. */
void shared_keep(struct shared_room *room, uint64_t ms);

/* Sets the error for speech or a command that is lost with its leader. */
void shared_error(struct error *e);

/* forward.c */
void forwards_close(struct shared_rooms *all);
void forwards_expire(struct shared_rooms *all); /* answers commands that have timed out */
void forwards_role(struct shared_room *room);   /* goes on with the room's commands, after its role was set */
void forwards_heard(struct shared_rooms *all, const struct packet *packet); /* a command from a replica */
void forwards_answered(struct shared_rooms *all,
                       const struct packet *packet); /* an answer to one of this daemon's commands */

/* Frees the forwarded command of an utterance that has ended. */
void forwards_ended(struct shared_room *room, uint32_t utterance);

/* Returns whether the utterance was requested by a command forwarded from here, and is to be spoken again
 * when lost. */
bool forwards_again(const struct shared_room *room, uint32_t utterance);

/* The leader is lost with all commands sent to it. Commands to be spoken again wait for the next leader
 * (if again), the others end. told: the utterance whose end was already sent, or 0. */
void forwards_lost(struct shared_room *room, uint32_t told, bool again, const struct error *e);

/* Marks an utterance of the leader as ended here, or as requested from another leader: its further output
 * is not passed on. */
void shared_is_past(struct shared_room *room, uint32_t utterance);

/* replicate.c: the cluster-wide number of a command, made from the sender's name and its number there;
 * never 0. The command keeps it when it is sent again to another leader. */
uint64_t shared_command(const char *daemon, uint64_t number);

/* Records that the command was run here; tests whether it was. */
void shared_note_done(struct shared_room *room, uint64_t command);
bool shared_has_done(const struct shared_room *room, uint64_t command);

/* Tests whether local followers were sent the end of the command's utterance, so that they must not hear
 * it again. The others record that end. */
bool shared_has_heard(const struct shared_room *room, uint64_t command);
void shared_note_heard(struct shared_room *room, const struct channel_item *item);
void shared_note_ended(struct shared_room *room, uint64_t command);

/* The room is being removed, and has no followers to notify. */
void forwards_forget_room(struct shared_room *room);

void shared_set_role(struct shared_room *room, enum shared_role role);
void shared_be_alone(struct shared_room *room);

/* Part of the leader's output was lost on the way: starts a new session with it. */
void shared_missed(struct shared_room *room);

/* Handles the answer to a claim. */
void shared_claimed(struct shared_room *room, const char *holder, uint64_t token, uint64_t asked);

/* leader.c: reports to the leader that this replica is there, and what it wants. */
void shared_report(struct shared_room *room);

/* replicas.c */
void replicas_report(struct shared_room *room, const struct packet *packet);
void replicas_said(const struct shared_room *room, const struct channel_item *const *items, size_t count);
void replicas_look(struct shared_room *room);
void replicas_drop(struct shared_room *room);

/* replicate.c: passes the leader's output on to local followers. */
void replicate(struct shared_room *room, const struct packet *packet);

/* forward.c */

struct forward {
    struct forward *prev, *next;
    struct shared_rooms *all;
    struct channel *channel; /* kept until the leader accepts the command */
    uint64_t number;
    uint64_t until; /* loop time of the timeout */
    json_t *asked;
    bool sent;
    bool again;         /* its utterance was lost once; wait for the next leader */
    uint32_t utterance; /* number that the leader gave it; 0: not accepted yet */
    unsigned tries;
    forward_done done; /* NULL: the caller no longer waits */
    void *ctx;
};

#endif
