/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Caches finished sentences. The key is everything that determines how a sentence sounds (voice, plugin,
 * spans with their prosody); the value is what the worker sent (frames of wire.h). The least recently used
 * entries are evicted. The cache is in memory and, if a file is named, also on disk; the file outlives the
 * process and is never trusted to be intact. */
#ifndef FACCIA_VOICE_VOICE_CACHE_H
#define FACCIA_VOICE_VOICE_CACHE_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include <stdbool.h>
#include <uv.h>

struct cache_options {
    uint64_t bytes;      /* in memory, keys and values; 0 = none */
    const char *file;    /* SQLite; NULL = none */
    uint64_t file_bytes; /* in the file */
};

struct voice_cache;

/* Logs a file that cannot be used and continues without it. Returns NULL when nothing is to be cached. */
struct voice_cache *cache_open(uv_loop_t *loop, const struct cache_options *options);

/* Pending writes finish while the loop runs. Accepts NULL. */
void cache_close(struct voice_cache *cache);

/* Returns the value, valid until the next call, or NULL. */
const struct buf *cache_get(struct voice_cache *cache, const struct buf *key);

/* Copies both. A value above a quarter of the space is not cached. */
void cache_put(struct voice_cache *cache, const struct buf *key, const struct buf *value);

/* The largest value that can be cached, in bytes. */
size_t cache_value_max(const struct voice_cache *cache);

/* SQLite's application_id in the file's header, "Facc" in ASCII. Only a file that was created as a cache
 * is ever used or recreated. */
#define CACHE_FILE_ID 0x46616363

/* Suffixes of the database's files; the first is "". */
extern const char *const cache_file_ends[4];

/* Returns 0 if the file is a cache, is empty or does not exist, else -1 with *e ("bad-cache"). Does not
 * change the file. */
int cache_file_check(const char *file, struct error *e);

#endif
