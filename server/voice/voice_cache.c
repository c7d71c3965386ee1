/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_cache.h"
#include "server/base/buf.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include <errno.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <uthash.h>
#include <uv.h>

const char *const cache_file_ends[4] = {"", "-wal", "-shm", "-journal"};

/* Layout of an SQLite database's header. */
enum { HEADER_BYTES = 100, ID_AT = 68 };
static const char magic[16] = "SQLite format 3";

/* Returns why the file is not a cache, or NULL. Does not block on a pipe. */
static const char *complaint(const char *file) {
    uint8_t header[HEADER_BYTES];
    struct stat info;
    int fd = open(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd < 0)
        return errno == EACCES ? "may not be read" : NULL; /* it does not exist */
    ssize_t n = fstat(fd, &info) || !S_ISREG(info.st_mode) ? -1 : pread(fd, header, sizeof header, 0);
    close(fd);
    if (n == 0)
        return NULL;
    if (n != HEADER_BYTES || memcmp(header, magic, sizeof magic) != 0)
        return "is not a sentence cache";
    uint32_t id = (uint32_t)header[ID_AT] << 24 | (uint32_t)header[ID_AT + 1] << 16 |
                  (uint32_t)header[ID_AT + 2] << 8 | header[ID_AT + 3];
    return id == CACHE_FILE_ID ? NULL : "is a database of something else";
}

int cache_file_check(const char *file, struct error *e) {
    const char *why = complaint(file);
    return why ? error_in_field(e, ERROR_BAD_CACHE, "--cache-file",
                                "%.120s %s; it is left unchanged: choose another file or remove it", file,
                                why)
               : 0;
}

/* Creates the file if needed, readable by its owner only. Failures show when it is opened. */
static void cache_file_prepare(const char *file) {
    char path[4096];
    int fd = open(file, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd >= 0)
        close(fd);
    for (size_t i = 0; i < sizeof cache_file_ends / sizeof *cache_file_ends; i++) {
        snprintf(path, sizeof path, "%s%s", file, cache_file_ends[i]);
        chmod(path, 0600);
    }
}

/* The database file, recreated when it is damaged. */

struct cache_database {
    const char *file;         /* borrowed */
    sqlite3 *reader, *writer; /* each used by one thread at a time; NULL = closed */
    sqlite3_stmt *get;
    dev_t device; /* identify the file: a replacement is not touched */
    ino_t number;
};

enum { BUSY_MS = 1000 };

/* Version of the schema; a file with another one is recreated. */
#define SCHEMA 1
#define SCHEMA_TEXT "1"

#define TEXT_OF(number) #number
#define TEXT(number) TEXT_OF(number)
#define CACHE_ID_TEXT TEXT(CACHE_FILE_ID)

static int schema_of(sqlite3 *sql) {
    sqlite3_stmt *statement = NULL;
    int number = -1;
    if (sqlite3_prepare_v2(sql, "PRAGMA user_version", -1, &statement, NULL) == SQLITE_OK &&
        sqlite3_step(statement) == SQLITE_ROW)
        number = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    return number;
}

/* Sets the application id first, before write-ahead logging starts, so that the file is recognised at
 * once. A crash loses the last sentences at most, and readers never wait for the writer. Large pages suit
 * sentences of about 100 kB. The log is checkpointed at 4 MB, as by default. */
static int prepare(sqlite3 *sql) {
    sqlite3_busy_timeout(sql, BUSY_MS);
    int number = schema_of(sql);
    if (number != 0 && number != SCHEMA)
        return SQLITE_CORRUPT;
    return sqlite3_exec(sql,
                        "PRAGMA page_size=16384; PRAGMA application_id=" CACHE_ID_TEXT ";"
                        "PRAGMA wal_autocheckpoint=250; PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL;"
                        "CREATE TABLE IF NOT EXISTS sentence (key BLOB PRIMARY KEY, value BLOB NOT NULL, "
                        "bytes INTEGER NOT NULL, used INTEGER NOT NULL) WITHOUT ROWID;"
                        "CREATE INDEX IF NOT EXISTS sentence_used ON sentence (used, bytes);"
                        "PRAGMA user_version=" SCHEMA_TEXT ";",
                        NULL, NULL, NULL);
}

static int open_database(struct cache_database *db) {
    struct stat info;
    cache_file_prepare(db->file);
    int result = sqlite3_open(db->file, &db->writer);
    if (!stat(db->file, &info)) {
        db->device = info.st_dev;
        db->number = info.st_ino;
    }
    if (result == SQLITE_OK)
        result = prepare(db->writer);
    if (result == SQLITE_OK)
        result = sqlite3_open_v2(db->file, &db->reader, SQLITE_OPEN_READONLY, NULL);
    if (result == SQLITE_OK)
        result =
            sqlite3_prepare_v2(db->reader, "SELECT value FROM sentence WHERE key = ?", -1, &db->get, NULL);
    return result;
}

static void cache_database_close(struct cache_database *db) {
    sqlite3_finalize(db->get);
    sqlite3_close(db->reader);
    sqlite3_close(db->writer);
    db->get = NULL;
    db->reader = db->writer = NULL;
}

static void remove_file(const char *file) {
    char path[4096];
    for (size_t i = 0; i < sizeof cache_file_ends / sizeof *cache_file_ends; i++) {
        snprintf(path, sizeof path, "%s%s", file, cache_file_ends[i]);
        unlink(path);
    }
}

/* Returns whether the path still refers to the open file, rather than to another cache. */
static bool is_same(const struct cache_database *db) {
    struct stat info;
    struct error e;
    if (stat(db->file, &info))
        return true; /* it was deleted */
    return (info.st_dev == db->device && info.st_ino == db->number) || !cache_file_check(db->file, &e);
}

static bool cache_database_is_damage(int result) {
    return result == SQLITE_CORRUPT || result == SQLITE_NOTADB;
}

/* Call while no write is in progress. */
static int cache_database_recreate(struct cache_database *db) {
    cache_database_close(db);
    if (!is_same(db)) {
        log_warn("another file has replaced the cache %s; the disk cache is disabled", db->file);
        return SQLITE_CANTOPEN;
    }
    log_warn("the cache %s is damaged or has another version; recreating it", db->file);
    remove_file(db->file);
    return open_database(db);
}

static int cache_database_open(struct cache_database *db) {
    int result = open_database(db);
    return cache_database_is_damage(result) ? cache_database_recreate(db) : result;
}

/* The cache on disk: one SQLite table, read on the loop's thread and written on libuv's thread pool, one
 * value at a time. */

struct cache_disk;

/* Opens or creates the file, recreating it if damaged. Logs and returns NULL when that fails or the file
 * is not a cache. */

/* Limit of queued writes. */
enum { WAITING_MAX = 64 };

struct write {
    struct write *next;
    struct buf key, value;
    bool touch; /* only update the time of use */
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
    bool damaged; /* recreate it when no write is in progress */
    bool complained, closing;
};

static void destroy(struct cache_disk *disk) {
    cache_database_close(&disk->db);
    free(disk->file);
    free(disk);
}

static struct cache_disk *cache_disk_open(uv_loop_t *loop, const char *file, uint64_t bytes) {
    struct error e;
    if (cache_file_check(file, &e)) {
        log_warn("the disk cache is disabled: %s", e.message);
        return NULL;
    }
    struct cache_disk *disk = mem_alloc(sizeof *disk);
    *disk = (struct cache_disk){.loop = loop, .room = bytes, .file = mem_strdup(file)};
    disk->db.file = disk->file;
    int result = cache_database_open(&disk->db);
    if (result != SQLITE_OK) {
        log_warn("the disk cache is disabled: %s: %s", file, sqlite3_errstr(result));
        destroy(disk);
        return NULL;
    }
    disk->work.data = disk;
    return disk;
}

/* Call while no write is in progress. */
static void mend(struct cache_disk *disk) {
    disk->damaged = false;
    cache_database_recreate(&disk->db);
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

/* Runs a statement of the writer with key, value, bytes, time and space as ?1 to ?5. */
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
    /* evict the least recently used entries */
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
        log_warn("cannot write to the disk cache: %s", sqlite3_errstr(disk->result));
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

/* Queues a write; drops it when too many wait. */
static void cache_disk_put(struct cache_disk *disk, const struct buf *key, const struct buf *value) {
    queue(disk, key, value);
}

/* Finishes the queued writes while the loop runs, then frees the disk. Accepts NULL. */
static void cache_disk_close(struct cache_disk *disk) {
    if (!disk)
        return;
    disk->closing = true;
    next_write(disk);
}

static bool has_key(const struct write *w, const struct buf *key) {
    return !w->touch && w->key.size == key->size && memcmp(w->key.data, key->data, key->size) == 0;
}

/* Returns the newest queued write for the key, or NULL. */
static const struct write *find_unwritten(const struct cache_disk *disk, const struct buf *key) {
    const struct write *found = NULL;
    if (disk->writing && has_key(disk->writing, key))
        found = disk->writing;
    for (const struct write *w = disk->waiting; w; w = w->next)
        if (has_key(w, key))
            found = w;
    return found;
}

/* Appends the value. Returns false if the key has none. */
static bool cache_disk_get(struct cache_disk *disk, const struct buf *key, struct buf *value) {
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

struct entry {
    struct buf key, value;
    UT_hash_handle hh; /* in order of use: the first is the least recently used */
};

struct voice_cache {
    size_t room, used;
    struct entry *entries;
    struct cache_disk *disk;
    struct buf found; /* value from disk that is too large for memory */
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
        /* move it to the end */
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
