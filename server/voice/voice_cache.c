/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_cache.h"
#include "server/base/mem.h"
#include "server/voice/voice_cache_disk.h"
#include <stdlib.h>
#include <uthash.h>

struct entry {
    struct buf key, value;
    UT_hash_handle hh; /* the table keeps the order: the first was not asked for for the longest time */
};

struct voice_cache {
    size_t room, used;
    struct entry *entries;
    struct cache_disk *disk;
    struct buf found; /* a value that came from the disk and is too large for the memory */
};

static void drop(struct voice_cache *cache, struct entry *entry) {
    HASH_DEL(cache->entries, entry);
    cache->used -= entry->key.size + entry->value.size;
    buf_free(&entry->key);
    buf_free(&entry->value);
    free(entry);
}

struct voice_cache *cache_open(uv_loop_t *loop, const struct cache_options *options) {
    struct cache_disk *disk =
        options->file && *options->file ? cache_disk_open(loop, options->file, options->file_bytes) : NULL;
    if (!options->bytes && !disk)
        return NULL;
    struct voice_cache *cache = mem_alloc(sizeof *cache);
    cache->room = options->bytes;
    cache->disk = disk;
    return cache;
}

void cache_close(struct voice_cache *cache) {
    struct entry *entry, *next;
    if (!cache)
        return;
    HASH_ITER(hh, cache->entries, entry, next) {
        drop(cache, entry);
    }
    cache_disk_close(cache->disk);
    buf_free(&cache->found);
    free(cache);
}

size_t cache_value_max(const struct voice_cache *cache) {
    enum { DISK_VALUE = 8 << 20 };
    size_t largest = cache->room / 4;
    return cache->disk && largest < DISK_VALUE ? DISK_VALUE : largest;
}

static struct entry *find(struct voice_cache *cache, const struct buf *key) {
    struct entry *entry;
    HASH_FIND(hh, cache->entries, key->data, key->size, entry);
    return entry;
}

static struct entry *remember(struct voice_cache *cache, const struct buf *key, const struct buf *value) {
    size_t need = key->size + value->size;
    if (need > cache->room / 4)
        return NULL;
    while (cache->used + need > cache->room)
        drop(cache, cache->entries);
    struct entry *entry = mem_alloc(sizeof *entry);
    buf_add(&entry->key, key->data, key->size);
    buf_add(&entry->value, value->data, value->size);
    HASH_ADD_KEYPTR(hh, cache->entries, entry->key.data, entry->key.size, entry);
    cache->used += need;
    return entry;
}

const struct buf *cache_get(struct voice_cache *cache, const struct buf *key) {
    struct entry *entry = find(cache, key);
    if (entry) {
        /* to the end of the order */
        HASH_DEL(cache->entries, entry);
        HASH_ADD_KEYPTR(hh, cache->entries, entry->key.data, entry->key.size, entry);
        return &entry->value;
    }
    cache->found.size = 0;
    if (!cache->disk || !cache_disk_get(cache->disk, key, &cache->found))
        return NULL;
    remember(cache, key, &cache->found);
    return &cache->found;
}

void cache_put(struct voice_cache *cache, const struct buf *key, const struct buf *value) {
    struct entry *entry = find(cache, key);
    if (value->size > cache_value_max(cache))
        return;
    if (entry)
        drop(cache, entry);
    remember(cache, key, value);
    if (cache->disk)
        cache_disk_put(cache->disk, key, value);
}
