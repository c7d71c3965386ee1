/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/quota.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <stdio.h>
#include <stdlib.h>
#include <uthash.h>
#include <utlist.h>

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

#define MINUTE_MS 60000

static struct quota_entry *quota_find(const struct quota *quota, const char *key) {
    struct quota_entry *entry;
    HASH_FIND_STR(quota->entries, key, entry);
    return entry;
}

static bool quota_closed(const struct quota_entry *entry) {
    return !entry->own.open && !entry->others;
}

static void quota_settle(struct quota *quota, const struct quota_entry *entry, bool was_closed) {
    quota->closed += quota_closed(entry);
    quota->closed -= was_closed;
}

static struct quota_entry *quota_find_or_add(struct quota *quota, const char *key) {
    struct quota_entry *entry = quota_find(quota, key);
    if (entry)
        return entry;
    entry = mem_alloc(sizeof *entry);
    entry->key = mem_strdup(key);
    HASH_ADD_KEYPTR(hh, quota->entries, entry->key, strlen(entry->key), entry);
    quota->closed++;
    return entry;
}

static void tell(const struct quota *quota, const struct quota_entry *entry) {
    if (quota->changed)
        quota->changed(quota->ctx, entry->key, &entry->own);
}

void quota_tell(const struct quota *quota) {
    for (const struct quota_entry *entry = quota->entries; entry; entry = entry->hh.next)
        tell(quota, entry);
}

static void quota_drop(struct quota *quota, struct quota_entry *entry) {
    entry->own = (struct quota_use){0};
    tell(quota, entry);
    quota->closed -= quota_closed(entry);
    HASH_DEL(quota->entries, entry);
    free(entry->key);
    free(entry);
}

/* Also drops the oldest closed entries while more than half of TALLY_CLOSED_MOST remain. */
void quota_sweep(struct quota *quota, uint64_t now) {
    struct quota_entry *entry, *next;
    uint64_t minute = now / MINUTE_MS;
    if (quota->swept == minute && quota->closed <= TALLY_CLOSED_MOST)
        return;
    HASH_ITER(hh, quota->entries, entry, next) {
        if (quota_closed(entry) && (entry->own.minute < minute || quota->closed > TALLY_CLOSED_MOST / 2))
            quota_drop(quota, entry);
    }
    quota->swept = minute;
}

bool quota_enter(struct quota *quota, const char *key, unsigned limit) {
    if (limit && quota_open(quota, key) >= limit)
        return false;
    struct quota_entry *entry = quota_find_or_add(quota, key);
    bool was_closed = quota_closed(entry);
    entry->own.open++;
    quota_settle(quota, entry, was_closed);
    tell(quota, entry);
    return true;
}

void quota_leave(struct quota *quota, const char *key) {
    struct quota_entry *entry = quota_find(quota, key);
    if (!entry || !entry->own.open)
        return;
    entry->own.open--;
    quota_settle(quota, entry, false);
    if (quota_closed(entry) && !entry->own.asked)
        quota_drop(quota, entry);
    else
        tell(quota, entry);
}

unsigned quota_open(const struct quota *quota, const char *key) {
    const struct quota_entry *entry = quota_find(quota, key);
    unsigned open = entry ? entry->own.open : 0;
    for (const struct quota_other *o = entry ? entry->others : NULL; o; o = o->next)
        open += o->use.open;
    return open;
}

bool quota_ask(struct quota *quota, const char *key, unsigned limit, uint64_t now) {
    uint64_t minute = now / MINUTE_MS;
    if (!limit)
        return true;
    quota_sweep(quota, now);
    struct quota_entry *entry = quota_find_or_add(quota, key);
    if (entry->own.minute != minute)
        entry->own.asked = 0;
    entry->own.minute = minute;
    uint64_t asked = entry->own.asked;
    for (const struct quota_other *o = entry->others; o; o = o->next)
        asked += o->use.minute == minute ? o->use.asked : 0;
    if (asked >= limit)
        return false;
    entry->own.asked++;
    tell(quota, entry);
    return true;
}

/* Counts from other daemons. */

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
        log_warn("cluster: other daemons report %d addresses and subjects; ignoring the rest",
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
