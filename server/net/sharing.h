/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What holds for all daemons of a cluster, by their board (cluster/board.h): how much an address or a subject
 * uses on all of them together, and which secrets of tokens, and which tokens, count no more. */
#ifndef FACCIA_NET_SHARING_H
#define FACCIA_NET_SHARING_H

#include <stdint.h>

struct net;
struct revoked;
struct sharing;

/* net->quota is counted together from now on. revoked: net->revoked or net->revocations has become longer. */
struct sharing *sharing_open(struct net *net, void (*revoked)(struct net *net));

/* The limits may be others now. NULL is fine in each of these. */
void sharing_change(struct sharing *sharing);

/* That secret counts no more, for any daemon. */
void sharing_revoke(struct sharing *sharing, const char *secret);

/* That token, or subject, counts no more, for any daemon. */
void sharing_revoke_token(struct sharing *sharing, const struct revoked *one);

/* Ms, by a clock whose minutes are those of all daemons, once the board has been seen. */
uint64_t sharing_now(const struct net *net);

/* Before the board is closed. */
void sharing_close(struct sharing *sharing);

#endif
