/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/quota.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <uthash.h>

#define MINUTE_MS 60000

struct quota_entry {
    char *key;
    unsigned open, asked;
    uint64_t minute;
    UT_hash_handle hh;
};

static struct quota_entry *find(const struct quota *quota, const char *key) {
    struct quota_entry *entry;
    HASH_FIND_STR(quota->entries, key, entry);
    return entry;
}

static struct quota_entry *find_or_add(struct quota *quota, const char *key) {
    struct quota_entry *entry = find(quota, key);
    if (entry)
        return entry;
    entry = mem_alloc(sizeof *entry);
    entry->key = mem_strdup(key);
    HASH_ADD_KEYPTR(hh, quota->entries, entry->key, strlen(entry->key), entry);
    quota->closed++;
    return entry;
}

static void drop(struct quota *quota, struct quota_entry *entry) {
    quota->closed -= !entry->open;
    HASH_DEL(quota->entries, entry);
    free(entry->key);
    free(entry);
}

/* What was asked in an earlier minute is forgotten; so is the oldest, when that is too much. */
static void sweep(struct quota *quota, uint64_t minute) {
    struct quota_entry *entry, *next;
    if (quota->swept == minute && quota->closed <= TALLY_CLOSED_MOST)
        return;
    HASH_ITER(hh, quota->entries, entry, next) {
        if (!entry->open && (entry->minute < minute || quota->closed > TALLY_CLOSED_MOST / 2))
            drop(quota, entry);
    }
    quota->swept = minute;
}

bool quota_enter(struct quota *quota, const char *key, unsigned limit) {
    if (limit && quota_open(quota, key) >= limit)
        return false;
    struct quota_entry *entry = find_or_add(quota, key);
    quota->closed -= !entry->open++;
    return true;
}

void quota_leave(struct quota *quota, const char *key) {
    struct quota_entry *entry = find(quota, key);
    if (!entry || --entry->open)
        return;
    quota->closed++;
    if (!entry->asked)
        drop(quota, entry);
}

unsigned quota_open(const struct quota *quota, const char *key) {
    const struct quota_entry *entry = find(quota, key);
    return entry ? entry->open : 0;
}

bool quota_ask(struct quota *quota, const char *key, unsigned limit, uint64_t now) {
    if (!limit)
        return true;
    sweep(quota, now / MINUTE_MS);
    struct quota_entry *entry = find_or_add(quota, key);
    if (entry->minute != now / MINUTE_MS)
        entry->asked = 0;
    entry->minute = now / MINUTE_MS;
    if (entry->asked >= limit)
        return false;
    entry->asked++;
    return true;
}

void quota_free(struct quota *quota) {
    struct quota_entry *entry, *next;
    HASH_ITER(hh, quota->entries, entry, next) {
        drop(quota, entry);
    }
}
