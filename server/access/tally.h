/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts for each address, or each subject of a token: what it has open, and what it asked for in the current
 * minute, whether or not something stays open. */
#ifndef FACCIA_ACCESS_TALLY_H
#define FACCIA_ACCESS_TALLY_H

#include <stdbool.h>
#include <stdint.h>

struct tally {
    struct tally_entry *entries;
    unsigned closed; /* entries that are kept for what they asked alone */
    uint64_t swept;  /* the minute in which such were looked for */
};

enum { TALLY_CLOSED_MOST = 65536 /* of those */ };

/* Limits of 0 = none. now: a clock in ms that does not go backwards. */

/* False, and nothing counted, when the key has `limit` open already. */
bool tally_enter(struct tally *tally, const char *key, unsigned limit);
void tally_leave(struct tally *tally, const char *key);
unsigned tally_open(const struct tally *tally, const char *key);

/* False when the key has asked `limit` times in the current minute. */
bool tally_ask(struct tally *tally, const char *key, unsigned limit, uint64_t now);

void tally_free(struct tally *tally);

#endif
