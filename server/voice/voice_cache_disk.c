/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_cache_disk.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/voice_cache_database.h"
#include "server/voice/voice_cache_file.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Values that may wait to be written. */
enum { WAITING_MAX = 64 };

struct write {
    struct write *next;
    struct buf key, value;
    bool touch; /* the value is there: it was asked for again */
};

struct cache_disk {
    uv_loop_t *loop;
    struct cache_database db;
    uint64_t room;
    struct write *waiting;
    unsigned waiting_count;
    uv_work_t work;
    struct write *writing; /* in the thread pool */
    int result;            /* of the last write */
    char *file;
    bool damaged; /* seen so; it is begun anew when nobody writes */
    bool complained, closing;
};

static void destroy(struct cache_disk *disk) {
    cache_database_close(&disk->db);
    free(disk->file);
    free(disk);
}

struct cache_disk *cache_disk_open(uv_loop_t *loop, const char *file, uint64_t bytes) {
    struct error e;
    if (cache_file_check(file, &e)) {
        log_warn("no cache on disk: %s", e.message);
        return NULL;
    }
    struct cache_disk *disk = mem_alloc(sizeof *disk);
    *disk = (struct cache_disk){.loop = loop, .room = bytes, .file = mem_strdup(file)};
    disk->db.file = disk->file;
    int result = cache_database_open(&disk->db);
    if (result != SQLITE_OK) {
        log_warn("no cache on disk: %s: %s", file, sqlite3_errstr(result));
        destroy(disk);
        return NULL;
    }
    disk->work.data = disk;
    return disk;
}

/* While nobody writes. */
static void mend(struct cache_disk *disk) {
    disk->damaged = false;
    cache_database_begin_anew(&disk->db);
}

static void free_write(struct write *w) {
    buf_free(&w->key);
    buf_free(&w->value);
    free(w);
}

static sqlite3_int64 now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (sqlite3_int64)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Runs a statement of the writer's with key, value, bytes and time as ?1 to ?4, as far as it has them. */
static int do_write(struct cache_disk *disk, const char *sql, const struct write *w) {
    sqlite3_stmt *statement = NULL;
    int result = sqlite3_prepare_v2(disk->db.writer, sql, -1, &statement, NULL);
    if (result != SQLITE_OK)
        return result;
    sqlite3_bind_blob64(statement, 1, w->key.data, w->key.size, SQLITE_STATIC);
    sqlite3_bind_blob64(statement, 2, w->value.data, w->value.size, SQLITE_STATIC);
    sqlite3_bind_int64(statement, 3, (sqlite3_int64)(w->key.size + w->value.size));
    sqlite3_bind_int64(statement, 4, now_ms());
    sqlite3_bind_int64(statement, 5, (sqlite3_int64)disk->room);
    result = sqlite3_step(statement);
    sqlite3_finalize(statement);
    return result == SQLITE_DONE ? SQLITE_OK : result;
}

static int write_one(struct cache_disk *disk, const struct write *w) {
    if (!disk->db.writer)
        return SQLITE_CANTOPEN;
    if (w->touch)
        return do_write(disk, "UPDATE sentence SET used = ?4 WHERE key = ?1", w);
    int result = do_write(
        disk, "INSERT OR REPLACE INTO sentence (key, value, bytes, used) VALUES (?1, ?2, ?3, ?4)", w);
    if (result != SQLITE_OK)
        return result;
    /* the oldest go: all that have more than the room in newer ones */
    return do_write(disk,
                    "DELETE FROM sentence WHERE (SELECT sum(bytes) FROM sentence) > ?5 AND key IN "
                    "(SELECT key FROM (SELECT key, sum(bytes) OVER (ORDER BY used DESC, key) AS total "
                    "FROM sentence) WHERE total > ?5)",
                    w);
}

static void in_thread(uv_work_t *work) {
    struct cache_disk *disk = work->data;
    disk->result = write_one(disk, disk->writing);
}

static void next_write(struct cache_disk *disk);

static void on_written(uv_work_t *work, int status) {
    struct cache_disk *disk = work->data;
    disk->damaged |= cache_database_is_damage(disk->result);
    if (!status && disk->result != SQLITE_OK && !disk->complained && !disk->damaged) {
        log_warn("the cache on disk takes no more: %s", sqlite3_errstr(disk->result));
        disk->complained = true;
    }
    free_write(disk->writing);
    disk->writing = NULL;
    if (disk->damaged)
        mend(disk);
    next_write(disk);
}

static void next_write(struct cache_disk *disk) {
    struct write *w = disk->waiting;
    if (disk->writing)
        return;
    if (!w) {
        if (disk->closing)
            destroy(disk);
        return;
    }
    disk->waiting = w->next;
    disk->waiting_count--;
    disk->writing = w;
    uv_queue_work(disk->loop, &disk->work, in_thread, on_written);
}

static void queue(struct cache_disk *disk, const struct buf *key, const struct buf *value) {
    if (disk->waiting_count >= WAITING_MAX)
        return;
    struct write *w = mem_alloc(sizeof *w), **last = &disk->waiting;
    buf_add(&w->key, key->data, key->size);
    w->touch = !value;
    if (value)
        buf_add(&w->value, value->data, value->size);
    while (*last)
        last = &(*last)->next;
    *last = w;
    disk->waiting_count++;
    next_write(disk);
}

void cache_disk_put(struct cache_disk *disk, const struct buf *key, const struct buf *value) {
    queue(disk, key, value);
}

void cache_disk_close(struct cache_disk *disk) {
    if (!disk)
        return;
    disk->closing = true;
    next_write(disk);
}

static bool has_key(const struct write *w, const struct buf *key) {
    return !w->touch && w->key.size == key->size && memcmp(w->key.data, key->data, key->size) == 0;
}

/* The newest value of the key that is still to be written. */
static const struct write *find_unwritten(const struct cache_disk *disk, const struct buf *key) {
    const struct write *found = NULL;
    if (disk->writing && has_key(disk->writing, key))
        found = disk->writing;
    for (const struct write *w = disk->waiting; w; w = w->next)
        if (has_key(w, key))
            found = w;
    return found;
}

bool cache_disk_get(struct cache_disk *disk, const struct buf *key, struct buf *value) {
    const struct write *unwritten = find_unwritten(disk, key);
    if (unwritten) {
        buf_add(value, unwritten->value.data, unwritten->value.size);
        return true;
    }
    if (!disk->db.get)
        return false;
    sqlite3_bind_blob64(disk->db.get, 1, key->data, key->size, SQLITE_STATIC);
    int result = sqlite3_step(disk->db.get);
    bool found = result == SQLITE_ROW;
    disk->damaged |= cache_database_is_damage(result);
    if (found)
        buf_add(value, sqlite3_column_blob(disk->db.get, 0), (size_t)sqlite3_column_bytes(disk->db.get, 0));
    sqlite3_reset(disk->db.get);
    if (disk->damaged && !disk->writing)
        mend(disk);
    else if (found)
        queue(disk, key, NULL);
    return found;
}
