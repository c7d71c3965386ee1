/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The part of the cache that lies on disk: a table of SQLite, read by the loop's thread and written by
 * libuv's thread pool, one value at a time. */
#ifndef FACCIA_VOICE_VOICE_CACHE_DISK_H
#define FACCIA_VOICE_VOICE_CACHE_DISK_H

#include "server/base/buf.h"
#include <stdbool.h>
#include <uv.h>

struct cache_disk;

/* NULL after a log line when the file cannot be opened or made, or is not a cache (cache_file.h). One that is
 * damaged is begun anew. Its owner alone may read it. */
struct cache_disk *cache_disk_open(uv_loop_t *loop, const char *file, uint64_t bytes);
/* What waits is still written, while the loop runs; then it is freed. NULL is fine. */
void cache_disk_close(struct cache_disk *disk);

/* Appends the value. False when there is none. */
bool cache_disk_get(struct cache_disk *disk, const struct buf *key, struct buf *value);

/* Writes later; when too many wait, or the disk is full, it is left. */
void cache_disk_put(struct cache_disk *disk, const struct buf *key, const struct buf *value);

#endif
