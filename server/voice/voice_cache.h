/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finished sentences, so that what was spoken once need not be spoken again. A key is all that makes a
 * sentence sound as it does (voice, plugin, spans with their prosody), a value what the worker said about it
 * (frames of wire.h). The oldest in use go when there is no room. Kept in memory, and on disk where a file is
 * named: that one outlives the process, and is never trusted to be whole. */
#ifndef FACCIA_VOICE_VOICE_CACHE_H
#define FACCIA_VOICE_VOICE_CACHE_H

#include "server/base/buf.h"
#include <uv.h>

struct cache_options {
    uint64_t bytes;      /* in memory, keys and values; 0 = none */
    const char *file;    /* SQLite; NULL = none */
    uint64_t file_bytes; /* in the file */
};

struct voice_cache;

/* A file that cannot be used is told in the log, and done without. NULL when nothing is to be kept. */
struct voice_cache *cache_open(uv_loop_t *loop, const struct cache_options *options);

/* What is still to be written to disk is written while the loop runs. NULL is fine. */
void cache_close(struct voice_cache *cache);

/* The value, which is good until the next call, or NULL. */
const struct buf *cache_get(struct voice_cache *cache, const struct buf *key);

/* Keeps copies of both. Too large a value (over a quarter of the room) is not kept. */
void cache_put(struct voice_cache *cache, const struct buf *key, const struct buf *value);

/* The most that a value may have. */
size_t cache_value_max(const struct voice_cache *cache);

#endif
