/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rooms that several daemons share. One daemon speaks in a room: it is the room's home, and holds a lease on
 * it (cluster/bus.h). Any other with followers of that room is a branch of it.
 *
 * Whoever has the room claims its lease again and again: the home to keep it, branches to take it over. A
 * branch tells its home that it is there, and in which ways it wants media (`here`); it is told first what
 * goes on (`recap`), then each message, once, with the bytes that the home's own followers get (`said`), and
 * hands on together what left together; it keeps what late joiners have to be told, as the home does. What a
 * client orders in a branch is sent to the home (`order`), which answers (`answer`). A home without the room
 * says so (`gone`).
 *
 * A message carries the token of the lease: it leaves only while the lease is held (the bus looks), and a
 * branch takes none but of the token that it knows as the last. A home whose lease has run out, as it was
 * asleep, does not go on for its own followers either until it has claimed it anew.
 *
 * When the home goes, what was spoken has ended as failed; who claims first is the next home. Without the bus
 * each daemon speaks for its own followers; what is spoken in a home goes on. When the bus is back, who
 * claims first is the home; any other that is speaking may come to its end, within HOME_HEAL_MS, and then
 * follows. */
#ifndef FACCIA_NET_HOMES_H
#define FACCIA_NET_HOMES_H

struct bus;
struct homes;
struct net;

enum { HOME_HEAL_MS = 10000 };

/* Rooms of the net are shared from now on. */
struct homes *homes_open(struct net *net, struct bus *bus);

/* Gives all leases up, and shares no more: before the bus is closed. NULL is fine. */
void homes_close(struct homes *homes);

#endif
