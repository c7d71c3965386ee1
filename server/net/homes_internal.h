/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of shared rooms have in common. */
#ifndef FACCIA_NET_HOMES_INTERNAL_H
#define FACCIA_NET_HOMES_INTERNAL_H

#include "server/cluster/bus.h"
#include "server/net/channel_internal.h"
#include "server/net/homes.h"
#include "server/net/net_internal.h"
#include "server/net/packet.h"

enum home_role {
    HOME_SEEKING,   /* nobody has answered yet who speaks */
    HOME_HERE,      /* this daemon */
    HOME_ELSEWHERE, /* another one */
    HOME_ALONE,     /* each for its own followers */
    HOME_ROLES,
};

enum {
    BRANCH_MS = 3000,      /* one that says nothing for so long is gone */
    HERE_MS = 1000,        /* it says so at least so often */
    BRANCHES_MOST = 256,   /* of one room; further ones are told nothing */
    RECENT_MOST = 128,     /* more than wait in a room, as a rule */
    BRANCH_ENCODINGS = 16, /* ways in which one may want media */
    LEASE_MARGIN_MS = 200, /* so long before its end the home waits for the new one */
    ORDER_MS = 4000,       /* an order is answered within that time, or not: longer than a lease */
};

/* Of a room whose home is here. */
struct branch {
    struct branch *next;
    char name[BUS_NAME_BYTES];
    uint64_t until; /* loop time */
    uint32_t visit; /* of the branch: which it has been told for what goes on */
    struct abroad abroad;
    struct follower all;                     /* stands for all who follow there */
    struct follower media[BRANCH_ENCODINGS]; /* in the room where media are wanted in that way */
};

struct recent {
    uint64_t number[RECENT_MOST];
    unsigned count; /* ever: the oldest make room */
};

struct home {
    struct homes *homes;
    struct channel *channel;
    enum home_role role;
    char holder[BUS_NAME_BYTES]; /* who speaks; of ELSEWHERE */
    uint64_t token;              /* under which that is */
    uint64_t above;              /* the highest that was heard of */
    uint64_t heal_by;            /* loop time; of ALONE, when the bus is there */
    uint64_t kept_until;         /* loop time; 0: it is not kept */
    struct branch *branches;
    uint64_t split;      /* the highest token before this daemon was alone: nobody goes on under it */
    struct recent past;  /* what has been told as ended here: its number, and whose (home_of) */
    struct recent ended; /* the same, of whatever home: which order had asked for it (home_order) */
    struct recent done;  /* orders that were done here, as the home */
    uint32_t deaf;       /* such a one, that is spoken */
    bool knew;           /* the room was followed here before that home was found */
    bool recapped;       /* a branch has been told what goes on */
    uint32_t visit;      /* which time it follows a home */
    uint32_t amid;       /* the utterance in whose middle it came to follow, until its begin is told */
    bool begin;          /* somebody waits for media that one can begin with */
    bool stale;          /* the home knows less than is */
    uint64_t here;       /* loop time when a branch has said last that it is there */
};

struct homes {
    struct net *net;
    struct bus *bus;
    uv_timer_t *tick, *soon;
    struct order *orders;
    uint64_t order_number;
    uint32_t visits; /* counted over all rooms: one that is left and entered anew is another visit, too */
};

/* home_base.c */
struct home *home_find(const struct homes *homes, const char *room);
uint64_t home_now(const struct homes *homes);
void home_claim(const struct home *home);

/* Sends it to one, under no lease; drops the head. */
void home_tell(const struct homes *homes, const char *to, json_t *head);

/* Which daemon sent that, and which time it follows (speech_request.h). */
uint64_t home_abroad(const struct packet *packet);

/* A daemon as a number of 31 bits, above 32 others; not 0. */
uint64_t home_of(const char *name);

/* As the home. */
void home_send(const struct home *home, const struct bus_receivers *to, const struct buf *data);

/* It is this daemon's no more, and the branches hear of it. */
void home_give_up(const struct home *home);
void home_give_up_as(const struct home *home, uint64_t token);

/* The room stays with its home for so long, though nobody follows: something waits there to be heard. */
void home_keep(struct home *home, uint64_t ms);

/* Why what was spoken, or ordered, is not. */
void home_error(struct error *e);

/* orders.c */
void orders_close(struct homes *homes);
void orders_look(struct homes *homes); /* what has waited too long is answered */
void orders_role(struct home *home);   /* those of that room, whose home is another */
void orders_heard(struct homes *homes, const struct packet *packet);    /* one from a branch */
void orders_answered(struct homes *homes, const struct packet *packet); /* to one of this daemon's */

/* order_ends.c: that utterance, which had been ordered here, has ended. */
void orders_ended(struct home *home, uint32_t utterance);

/* Has that utterance been ordered here, and is it to be spoken again? */
bool orders_again(const struct home *home, uint32_t utterance);

/* The home is lost with all that was asked of it: what is to be spoken again waits for the next one (again:
 * at all), the others end. The utterance `told` (or 0) has had its end. */
void orders_lost(struct home *home, uint32_t told, bool again, const struct error *e);

/* An utterance of the home has been told as ended here, or is asked of another: what comes of it yet is not
 * handed on. */
void home_is_past(struct home *home, uint32_t utterance);
bool home_was_past(const struct home *home, uint32_t utterance);

/* home_heard.c: an order among those of all daemons, by who gave it and its number there; not 0. It keeps it
 * when it is given anew to another home. */
uint64_t home_order(const char *asker, uint64_t number);

/* It was done here; and was it? */
void home_does(struct home *home, uint64_t order);
bool home_has_done(const struct home *home, uint64_t order);

/* Those who follow here have been told the end of what it asked for: they are not to hear it once more. */
bool home_has_heard(const struct home *home, uint64_t order);
void home_hears(struct home *home, const struct channel_item *item);
void home_told(struct home *home, uint64_t order);

/* The room is here no more: nobody follows who could be told. */
void orders_forget_room(struct home *home);

/* home_roles.c */
void home_set_role(struct home *home, enum home_role role);
void home_be_alone(struct home *home);

/* Something that the home said has not been heard here: follows it anew. */
void home_missed(struct home *home);

/* The answer to a claim. */
void home_claimed(struct home *home, const char *holder, uint64_t token, uint64_t asked);

/* home_here.c: tells the home that the branch is there, and what it wants. */
void home_here(struct home *home);

/* branches.c */
void branches_here(struct home *home, const struct packet *packet);
void branches_said(const struct home *home, const struct channel_item *const *items, size_t count);
void branches_look(struct home *home);
void branches_drop(struct home *home);

/* hand_on.c: what the home has said goes to those who follow here. */
void hand_on(struct home *home, const struct packet *packet);

#endif
