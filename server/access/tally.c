/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/tally.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <uthash.h>

#define MINUTE_MS 60000

struct tally_entry {
    char *key;
    unsigned open, asked;
    uint64_t minute;
    UT_hash_handle hh;
};

static struct tally_entry *find(const struct tally *tally, const char *key) {
    struct tally_entry *entry;
    HASH_FIND_STR(tally->entries, key, entry);
    return entry;
}

static struct tally_entry *find_or_add(struct tally *tally, const char *key) {
    struct tally_entry *entry = find(tally, key);
    if (entry)
        return entry;
    entry = mem_alloc(sizeof *entry);
    entry->key = mem_strdup(key);
    HASH_ADD_KEYPTR(hh, tally->entries, entry->key, strlen(entry->key), entry);
    tally->closed++;
    return entry;
}

static void drop(struct tally *tally, struct tally_entry *entry) {
    tally->closed -= !entry->open;
    HASH_DEL(tally->entries, entry);
    free(entry->key);
    free(entry);
}

/* What was asked in an earlier minute is forgotten; so is the oldest, when that is too much. */
static void sweep(struct tally *tally, uint64_t minute) {
    struct tally_entry *entry, *next;
    if (tally->swept == minute && tally->closed <= TALLY_CLOSED_MOST)
        return;
    HASH_ITER(hh, tally->entries, entry, next) {
        if (!entry->open && (entry->minute < minute || tally->closed > TALLY_CLOSED_MOST / 2))
            drop(tally, entry);
    }
    tally->swept = minute;
}

bool tally_enter(struct tally *tally, const char *key, unsigned limit) {
    if (limit && tally_open(tally, key) >= limit)
        return false;
    struct tally_entry *entry = find_or_add(tally, key);
    tally->closed -= !entry->open++;
    return true;
}

void tally_leave(struct tally *tally, const char *key) {
    struct tally_entry *entry = find(tally, key);
    if (!entry || --entry->open)
        return;
    tally->closed++;
    if (!entry->asked)
        drop(tally, entry);
}

unsigned tally_open(const struct tally *tally, const char *key) {
    const struct tally_entry *entry = find(tally, key);
    return entry ? entry->open : 0;
}

bool tally_ask(struct tally *tally, const char *key, unsigned limit, uint64_t now) {
    if (!limit)
        return true;
    sweep(tally, now / MINUTE_MS);
    struct tally_entry *entry = find_or_add(tally, key);
    if (entry->minute != now / MINUTE_MS)
        entry->asked = 0;
    entry->minute = now / MINUTE_MS;
    if (entry->asked >= limit)
        return false;
    entry->asked++;
    return true;
}

void tally_free(struct tally *tally) {
    struct tally_entry *entry, *next;
    HASH_ITER(hh, tally->entries, entry, next) {
        drop(tally, entry);
    }
}
