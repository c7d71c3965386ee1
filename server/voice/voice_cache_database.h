/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The database of the cache on disk: opened, made when it is not there, begun anew when it is damaged. */
#ifndef FACCIA_VOICE_VOICE_CACHE_DATABASE_H
#define FACCIA_VOICE_VOICE_CACHE_DATABASE_H

#include <sqlite3.h>
#include <stdbool.h>
#include <sys/stat.h>

struct cache_database {
    const char *file;         /* borrowed */
    sqlite3 *reader, *writer; /* each used by one thread at a time; NULL when it is not open */
    sqlite3_stmt *get;
    dev_t device; /* which file it is: another one in its place is not touched */
    ino_t number;
};

/* A result of SQLite. */
int cache_database_open(struct cache_database *db);
void cache_database_close(struct cache_database *db);

bool cache_database_is_damage(int result);

/* While nobody writes. */
int cache_database_begin_anew(struct cache_database *db);

#endif
