/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internal declarations shared by the files of the quotas. */
#ifndef FACCIA_ACCESS_QUOTA_INTERNAL_H
#define FACCIA_ACCESS_QUOTA_INTERNAL_H

#include "server/access/quota.h"
#include <uthash.h>

enum { QUOTA_OWNER_BYTES = 33 };

struct quota_other {
    struct quota_other *next;
    char owner[QUOTA_OWNER_BYTES];
    struct quota_use use;
};

struct quota_entry {
    char *key;
    struct quota_use own;
    struct quota_other *others;
    UT_hash_handle hh;
};

struct quota_entry *quota_find(const struct quota *quota, const char *key);
struct quota_entry *quota_find_or_add(struct quota *quota, const char *key);

/* Returns whether the entry is kept only for requests made here. Code that changes an entry must pass its
 * earlier state to quota_settle. */
bool quota_closed(const struct quota_entry *entry);
void quota_settle(struct quota *quota, const struct quota_entry *entry, bool was_closed);
void quota_drop(struct quota *quota, struct quota_entry *entry);

#endif
