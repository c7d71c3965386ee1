/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/library/index_internal.h"
#include "server/library/search_rank.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SCHEMA "4"
#define APPLICATION "1717985378" /* "fabl" */

static const char schema[] =
    "PRAGMA application_id=" APPLICATION ";"
    "PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL; PRAGMA cache_size=-32768;"
    "CREATE TABLE IF NOT EXISTS file (path TEXT PRIMARY KEY, size INTEGER, modified INTEGER, hash TEXT, work "
    "TEXT) "
    "WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS work (name TEXT PRIMARY KEY, path TEXT, hash TEXT, title TEXT, author TEXT, "
    "lang TEXT, "
    "date TEXT, publisher TEXT, licence TEXT, source TEXT, format TEXT, sections INTEGER, passages INTEGER, "
    "characters INTEGER, first INTEGER, last INTEGER, recording INTEGER) WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS section (work TEXT, number INTEGER, title TEXT, level INTEGER, passages "
    "INTEGER, "
    "characters INTEGER, first INTEGER, last INTEGER, PRIMARY KEY (work, number)) WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS passage (id INTEGER PRIMARY KEY, work TEXT, section INTEGER, name TEXT, kind "
    "INTEGER, "
    "part INTEGER, start INTEGER, first_line INTEGER, line_count INTEGER, lang TEXT, shape TEXT, text TEXT, "
    "source TEXT, "
    "markup TEXT, runs TEXT);"
    "CREATE INDEX IF NOT EXISTS passage_name ON passage (work, section, name);"
    "CREATE INDEX IF NOT EXISTS passage_line ON passage (work, section, first_line) WHERE line_count > 0;"
    "CREATE TABLE IF NOT EXISTS problem (path TEXT, code TEXT, line INTEGER, col INTEGER, message TEXT, "
    "serious "
    "INTEGER);"
    "CREATE INDEX IF NOT EXISTS problem_path ON problem (path);"
    "CREATE VIRTUAL TABLE IF NOT EXISTS found USING fts5 (word, stem, content='', "
    "tokenize='unicode61 remove_diacritics 2');"
    "INSERT INTO found (found, rank) VALUES ('hashsize', 33554432);"
    "PRAGMA user_version=" SCHEMA ";";

static int64_t number_of(sqlite3 *sql, const char *query) {
    sqlite3_stmt *s = NULL;
    int64_t number = -1;
    if (sqlite3_prepare_v2(sql, query, -1, &s, NULL) == SQLITE_OK && sqlite3_step(s) == SQLITE_ROW)
        number = sqlite3_column_int64(s, 0);
    sqlite3_finalize(s);
    return number;
}

bool index_is_damaged(sqlite3 *sql) {
    int code = sqlite3_errcode(sql) & 0xff;
    return code == SQLITE_CORRUPT || code == SQLITE_NOTADB;
}

void index_discard(const char *file) {
    static const char *const ends[] = {"", "-wal", "-shm"};
    char path[4096];
    log_warn("the index %s is damaged or of another version; it is begun anew", file);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        snprintf(path, sizeof path, "%s%s", file, ends[i]);
        unlink(path);
    }
}

static int fail(struct index_writer *w, struct error *e) {
    sqlite3 *sql = w->sql;
    w->damaged = w->damaged || index_is_damaged(sql);
    return error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(sql));
}

static int try_open(struct index_writer *w, const char *file) {
    if (sqlite3_open(file, &w->sql) != SQLITE_OK)
        return -1;
    sqlite3_busy_timeout(w->sql, 5000);
    int64_t version = number_of(w->sql, "PRAGMA user_version");
    int64_t application = number_of(w->sql, "PRAGMA application_id");
    if (version < 0 || application < 0)
        return -1;
    if (application && application != 1717985378)
        return 1; /* somebody else's */
    if ((version && version != atoi(SCHEMA)) || sqlite3_exec(w->sql, schema, NULL, NULL, NULL) != SQLITE_OK)
        return -1;
    w->next = number_of(w->sql, "SELECT coalesce(max(id), 0) + 1 FROM passage");
    return w->next > 0 ? 0 : -1;
}

int index_open(struct index_writer *w, const char *file, struct error *e) {
    *w = (struct index_writer){0};
    int result = try_open(w, file);
    if (result < 0 && w->sql && !access(file, R_OK | W_OK)) {
        sqlite3_close(w->sql);
        index_discard(file);
        result = try_open(w, file);
    }
    if (result > 0)
        error_set(e, ERROR_BAD_INDEX, "%.200s is another program's", file);
    else if (result)
        error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", file, sqlite3_errmsg(w->sql));
    if (result) {
        sqlite3_close(w->sql);
        w->sql = NULL;
        return -1;
    }
    w->stems = stems_open();
    return 0;
}

void index_close(struct index_writer *w) {
    index_roll_back(w);
    for (size_t i = 0; i < sizeof w->statements / sizeof *w->statements; i++)
        sqlite3_finalize(w->statements[i]);
    sqlite3_close(w->sql);
    stems_close(w->stems);
    *w = (struct index_writer){0};
}

/* The file is not mapped: one that somebody cuts, or a disk that fails, would end the daemon with SIGBUS. */
sqlite3 *index_open_reader(const char *file) {
    sqlite3 *sql = NULL;
    if (sqlite3_open_v2(file, &sql, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, NULL) != SQLITE_OK ||
        sqlite3_exec(sql, "PRAGMA query_only=1; PRAGMA cache_size=-16384;", NULL, NULL, NULL) != SQLITE_OK ||
        search_rank_add(sql)) {
        sqlite3_close(sql);
        return NULL;
    }
    sqlite3_busy_timeout(sql, 1000);
    return sql;
}

sqlite3_stmt *index_statement(struct index_writer *w, unsigned number, const char *sql) {
    sqlite3_stmt **s = &w->statements[number];
    if (!*s && sqlite3_prepare_v3(w->sql, sql, -1, SQLITE_PREPARE_PERSISTENT, s, NULL) != SQLITE_OK)
        log_warn("the index: %s", sqlite3_errmsg(w->sql));
    sqlite3_clear_bindings(*s);
    return *s;
}

int index_step(struct index_writer *w, sqlite3_stmt *statement, struct error *e) {
    int result = statement ? sqlite3_step(statement) : SQLITE_ERROR;
    if (result != SQLITE_ROW && result != SQLITE_DONE) {
        fail(w, e);
        sqlite3_reset(statement);
        return -1;
    }
    if (result == SQLITE_DONE)
        sqlite3_reset(statement);
    return result == SQLITE_ROW;
}

int index_begin(struct index_writer *w, struct error *e) {
    if (!w->open && sqlite3_exec(w->sql, "BEGIN", NULL, NULL, NULL) != SQLITE_OK)
        return fail(w, e);
    w->open = true;
    return 0;
}

int index_commit(struct index_writer *w, struct error *e) {
    if (!w->open)
        return 0;
    w->characters = 0;
    if (sqlite3_exec(w->sql, "COMMIT", NULL, NULL, NULL) != SQLITE_OK) {
        fail(w, e);
        index_roll_back(w);
        return -1;
    }
    w->open = false;
    return 0;
}

void index_roll_back(struct index_writer *w) {
    if (!w->open)
        return;
    sqlite3_exec(w->sql, "ROLLBACK", NULL, NULL, NULL);
    w->open = false;
    w->next = number_of(w->sql, "SELECT coalesce(max(id), 0) + 1 FROM passage");
}
