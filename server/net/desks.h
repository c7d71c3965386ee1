/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Those who look on in a room are told of each other, by name; who listens there is not told of them. */
#ifndef FACCIA_NET_DESKS_H
#define FACCIA_NET_DESKS_H

enum {
    DESK_NAME_BYTES = 64,
    DESKS_TOLD = 32, /* most that are told of, the first to come */
};

struct channel;
struct follower;

/* Somebody who looks on has come, gone, or got another name or other rights. */
void desks_tell(struct channel *channel);

/* Leaves the channel; those who are left are told, where they knew of it. */
void desks_leave(struct follower *follower);

#endif
