/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts for each address, or each subject of a token: what it has open, and what it asked for in the current
 * minute, whether or not something stays open. */
#ifndef FACCIA_ACCESS_QUOTA_H
#define FACCIA_ACCESS_QUOTA_H

#include <stdbool.h>
#include <stdint.h>

struct quota {
    struct quota_entry *entries;
    unsigned closed; /* entries that are kept for what they asked alone */
    uint64_t swept;  /* the minute in which such were looked for */
};

enum { TALLY_CLOSED_MOST = 65536 /* of those */ };

/* Limits of 0 = none. now: a clock in ms that does not go backwards. */

/* False, and nothing counted, when the key has `limit` open already. */
bool quota_enter(struct quota *quota, const char *key, unsigned limit);
void quota_leave(struct quota *quota, const char *key);
unsigned quota_open(const struct quota *quota, const char *key);

/* False when the key has asked `limit` times in the current minute. */
bool quota_ask(struct quota *quota, const char *key, unsigned limit, uint64_t now);

void quota_free(struct quota *quota);

#endif
