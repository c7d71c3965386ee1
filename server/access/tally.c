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

static struct tally_entry *find(struct tally *tally, const char *key) {
    struct tally_entry *entry;
    HASH_FIND_STR(tally->entries, key, entry);
    return entry;
}

bool tally_enter(struct tally *tally, const char *key, unsigned limit) {
    struct tally_entry *entry = find(tally, key);
    if (entry && limit && entry->open >= limit)
        return false;
    if (!entry) {
        entry = mem_alloc(sizeof *entry);
        entry->key = mem_strdup(key);
        HASH_ADD_KEYPTR(hh, tally->entries, entry->key, strlen(entry->key), entry);
    }
    entry->open++;
    return true;
}

static void drop(struct tally *tally, struct tally_entry *entry) {
    HASH_DEL(tally->entries, entry);
    free(entry->key);
    free(entry);
}

void tally_leave(struct tally *tally, const char *key) {
    struct tally_entry *entry = find(tally, key);
    if (entry && --entry->open == 0)
        drop(tally, entry);
}

bool tally_ask(struct tally *tally, const char *key, unsigned limit, uint64_t now) {
    struct tally_entry *entry = find(tally, key);
    if (!entry || !limit)
        return true;
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
