/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts for each address, or each subject of a token: what it has open, and what it asked for in the current
 * minute, whether or not something stays open; here, and as other daemons tell (quota_seen). */
#ifndef FACCIA_ACCESS_QUOTA_H
#define FACCIA_ACCESS_QUOTA_H

#include <stdbool.h>
#include <stdint.h>

/* What one daemon counts of a key. */
struct quota_use {
    unsigned open, asked;
    uint64_t minute; /* in which that was asked */
};

struct quota {
    struct quota_entry *entries;
    unsigned closed; /* entries that are kept for what they asked here alone */
    unsigned others; /* uses of other daemons */
    uint64_t swept;  /* the minute in which the closed ones were looked for */
    /* What this daemon counts of the key is that from now on; all 0: it is forgotten. NULL: nobody is told.
     */
    void (*changed)(void *ctx, const char *key, const struct quota_use *use);
    void *ctx;
};

enum {
    TALLY_CLOSED_MOST = 65536,  /* of those */
    TALLY_OTHERS_MOST = 262144, /* further ones are not counted */
};

/* Limits of 0 = none. now: a clock in ms that does not go backwards, and whose minutes are those of the other
 * daemons. */

/* False, and nothing counted, when the key has `limit` open already. */
bool quota_enter(struct quota *quota, const char *key, unsigned limit);
void quota_leave(struct quota *quota, const char *key);
unsigned quota_open(const struct quota *quota, const char *key);

/* False when the key has asked `limit` times in the current minute. */
bool quota_ask(struct quota *quota, const char *key, unsigned limit, uint64_t now);

/* Forgets what was asked in earlier minutes; quota_ask does so, too. */
void quota_sweep(struct quota *quota, uint64_t now);

/* Says what this daemon counts of each key, to `changed`. */
void quota_tell(const struct quota *quota);

/* quota_others.c: what another daemon counts, in place of what it counted before; all 0: nothing any more. */
void quota_seen(struct quota *quota, const char *owner, const char *key, const struct quota_use *use);

/* That daemon has gone; NULL: all others have. */
void quota_gone(struct quota *quota, const char *owner);

void quota_free(struct quota *quota);

#endif
