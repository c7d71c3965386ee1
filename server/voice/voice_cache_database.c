/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_cache_database.h"
#include "server/base/log.h"
#include "server/voice/voice_cache_file.h"
#include <stdio.h>
#include <unistd.h>

enum { BUSY_MS = 1000 };

/* The schema's number; a file of another is begun anew. */
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

/* The first thing written is whose file it is, at once: write-ahead logging begins after it. A crash loses
 * the last sentences at most, and a reader never waits for a writer. A sentence is some 100 kB: large pages
 * are read faster. The log is emptied at 4 MB, as by default. */
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

void cache_database_close(struct cache_database *db) {
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

/* Nobody has put another file in its place. */
static bool is_same(const struct cache_database *db) {
    struct stat info;
    struct error e;
    if (stat(db->file, &info))
        return true; /* it is gone */
    return (info.st_dev == db->device && info.st_ino == db->number) || !cache_file_check(db->file, &e);
}

bool cache_database_is_damage(int result) {
    return result == SQLITE_CORRUPT || result == SQLITE_NOTADB;
}

/* While nobody writes. */
int cache_database_begin_anew(struct cache_database *db) {
    cache_database_close(db);
    if (!is_same(db)) {
        log_warn("there is another file in the place of the cache %s; nothing more is kept on disk",
                 db->file);
        return SQLITE_CANTOPEN;
    }
    log_warn("the cache %s is damaged or of another version; it is begun anew", db->file);
    remove_file(db->file);
    return open_database(db);
}

int cache_database_open(struct cache_database *db) {
    int result = open_database(db);
    return cache_database_is_damage(result) ? cache_database_begin_anew(db) : result;
}
