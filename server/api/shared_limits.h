/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits shared by all daemons of a cluster through their presence (cluster/cluster.h): the usage of each
 * address and subject, and the revoked secrets and tokens. */
#ifndef FACCIA_API_SHARED_LIMITS_H
#define FACCIA_API_SHARED_LIMITS_H

#include <stdint.h>

struct api;
struct revoked;
struct shared_limits;

/* Starts to share api->quota. Calls `revoked` when api->revoked or api->revocations has grown. */
struct shared_limits *shared_limits_open(struct api *api, void (*revoked)(struct api *api));

/* Call after the limits may have changed. `sharing` may be NULL, here and below. */
void shared_limits_change(struct shared_limits *sharing);

/* Revokes the secret on every daemon. */
void shared_limits_revoke(struct shared_limits *sharing, const char *secret);

/* Revokes the token or the subject on every daemon. */
void shared_limits_revoke_token(struct shared_limits *sharing, const struct revoked *one);

/* Current time, ms. Its minutes are the same on all daemons once the store has been read. */
uint64_t shared_limits_now(const struct api *api);

/* Call before closing the store. */
void shared_limits_close(struct shared_limits *sharing);

#endif
