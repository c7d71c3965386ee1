/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What holds for all daemons of a cluster, by their board (cluster/board.h): how much an address or a subject
 * uses on all of them together, and which secrets of tokens, and which tokens, count no more. */
#ifndef FACCIA_API_SHARED_LIMITS_H
#define FACCIA_API_SHARED_LIMITS_H

#include <stdint.h>

struct api;
struct revoked;
struct shared_limits;

/* api->quota is counted together from now on. revoked: api->revoked or api->revocations has become longer. */
struct shared_limits *shared_limits_open(struct api *api, void (*revoked)(struct api *api));

/* The limits may be others now. NULL is fine in each of these. */
void shared_limits_change(struct shared_limits *sharing);

/* That secret counts no more, for any daemon. */
void shared_limits_revoke(struct shared_limits *sharing, const char *secret);

/* That token, or subject, counts no more, for any daemon. */
void shared_limits_revoke_token(struct shared_limits *sharing, const struct revoked *one);

/* Ms, by a clock whose minutes are those of all daemons, once the board has been seen. */
uint64_t shared_limits_now(const struct api *api);

/* Before the board is closed. */
void shared_limits_close(struct shared_limits *sharing);

#endif
