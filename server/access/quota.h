/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts, for each address or token subject (the key): open connections, and requests in the current
 * minute, whether or not the connection stays open. Includes what other daemons report (quota_seen). */
#ifndef FACCIA_ACCESS_QUOTA_H
#define FACCIA_ACCESS_QUOTA_H

#include <stdbool.h>
#include <stdint.h>

/* One daemon's counts for a key. */
struct quota_use {
    unsigned open, asked;
    uint64_t minute; /* the minute that `asked` counts */
};

struct quota {
    struct quota_entry *entries;
    unsigned closed; /* entries kept only for requests made here */
    unsigned others; /* counts from other daemons */
    uint64_t swept;  /* minute of the last sweep of closed entries */
    /* This daemon's counts for the key have changed; all 0: the key is forgotten. NULL: no callback. */
    void (*changed)(void *ctx, const char *key, const struct quota_use *use);
    void *ctx;
};

enum {
    TALLY_CLOSED_MOST = 65536,  /* most closed entries */
    TALLY_OTHERS_MOST = 262144, /* most counts from other daemons; further ones are ignored */
};

/* A limit of 0 = none. now: a monotonic clock in ms, whose minutes coincide on all daemons. */

/* Counts one more open connection. Returns false, and counts nothing, when the key already has `limit`
 * open. */
bool quota_enter(struct quota *quota, const char *key, unsigned limit);
void quota_leave(struct quota *quota, const char *key);
unsigned quota_open(const struct quota *quota, const char *key);

/* Counts a request. Returns false when the key has made `limit` requests in the current minute. */
bool quota_ask(struct quota *quota, const char *key, unsigned limit, uint64_t now);

/* Forgets the requests of earlier minutes; quota_ask does so too. */
void quota_sweep(struct quota *quota, uint64_t now);

/* Reports this daemon's counts for every key to `changed`. */
void quota_tell(const struct quota *quota);

/* quota_others.c: replaces another daemon's counts for the key; all 0: removes them. */
void quota_seen(struct quota *quota, const char *owner, const char *key, const struct quota_use *use);

/* Removes the counts of one daemon; NULL: of all others. */
void quota_gone(struct quota *quota, const char *owner);

void quota_free(struct quota *quota);

#endif
