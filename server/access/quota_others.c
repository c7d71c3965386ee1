/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts from other daemons. */
#include "server/access/quota_internal.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <stdio.h>
#include <stdlib.h>
#include <utlist.h>

static bool is_nothing(const struct quota_use *use) {
    return !use->open && !use->asked;
}

static void forget(struct quota *quota, struct quota_entry *entry, struct quota_other *other) {
    LL_DELETE(entry->others, other);
    free(other);
    quota->others--;
}

static void drop_if_empty(struct quota *quota, struct quota_entry *entry) {
    if (quota_closed(entry) && is_nothing(&entry->own))
        quota_drop(quota, entry);
}

static struct quota_other *add(struct quota *quota, struct quota_entry *entry, const char *owner) {
    struct quota_other *other = mem_alloc(sizeof *other);
    snprintf(other->owner, sizeof other->owner, "%s", owner);
    LL_PREPEND(entry->others, other);
    if (++quota->others == TALLY_OTHERS_MOST)
        log_warn("cluster: other daemons count for %d addresses and subjects; further ones are left out",
                 TALLY_OTHERS_MOST);
    return other;
}

void quota_seen(struct quota *quota, const char *owner, const char *key, const struct quota_use *use) {
    struct quota_entry *entry = quota_find(quota, key);
    struct quota_other *other = entry ? entry->others : NULL;
    while (other && strcmp(other->owner, owner) != 0)
        other = other->next;
    if (!other && (is_nothing(use) || quota->others >= TALLY_OTHERS_MOST))
        return;
    if (!entry)
        entry = quota_find_or_add(quota, key);
    bool was_closed = quota_closed(entry);
    if (!other)
        other = add(quota, entry, owner);
    other->use = *use;
    if (is_nothing(use))
        forget(quota, entry, other);
    quota_settle(quota, entry, was_closed);
    drop_if_empty(quota, entry);
}

void quota_gone(struct quota *quota, const char *owner) {
    struct quota_entry *entry, *next_entry;
    struct quota_other *other, *next;
    HASH_ITER(hh, quota->entries, entry, next_entry) {
        bool was_closed = quota_closed(entry);
        LL_FOREACH_SAFE(entry->others, other, next) {
            if (!owner || !strcmp(other->owner, owner))
                forget(quota, entry, other);
        }
        quota_settle(quota, entry, was_closed);
        drop_if_empty(quota, entry);
    }
}

void quota_free(struct quota *quota) {
    struct quota_entry *entry, *next;
    quota->changed = NULL;
    quota_gone(quota, NULL);
    HASH_ITER(hh, quota->entries, entry, next) {
        quota_drop(quota, entry);
    }
}
