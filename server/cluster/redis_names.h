/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The names under which Redis keeps a sentence. */
#ifndef FACCIA_CLUSTER_REDIS_NAMES_H
#define FACCIA_CLUSTER_REDIS_NAMES_H

#include "server/base/buf.h"

enum { REDIS_NAME_BYTES = 96, REDIS_ID_BYTES = 33, REDIS_HASH_BYTES = 65 };

/* What is in braces lies on one server of a Redis cluster. */
struct redis_names {
    char value[REDIS_NAME_BYTES], claim[REDIS_NAME_BYTES];
};

/* SHA-256 of the key, in hexadecimal digits. */
void redis_hash_of(const struct buf *key, char hex[REDIS_HASH_BYTES]);

/* By that of the key. */
void redis_names_of(const struct buf *key, struct redis_names *names);

/* A name that no other daemon has. */
void redis_id_make(char id[REDIS_ID_BYTES]);

#endif
