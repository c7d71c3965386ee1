/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The works by when their files changed, for feeds and sitemaps. */
#include "server/library/library_internal.h"
#include <time.h>

enum { NS = 1000000000 };

/* RFC 3339, in UTC. */
static json_t *time_of(int64_t ns) {
    char text[32];
    struct tm utc;
    time_t seconds = (time_t)(ns / NS);
    gmtime_r(&seconds, &utc);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return json_string(text);
}

json_t *library_newest_json(struct index_reader *r, unsigned most, struct error *e) {
    sqlite3_stmt *s = library_prepare(
        r,
        "SELECT w.name, w.title, w.author, w.lang, w.date, w.sections, w.recording, coalesce(f.modified, 0) "
        "FROM work w LEFT JOIN file f ON f.path = w.path ORDER BY 8 DESC, w.name LIMIT ?",
        e);
    json_t *works = s ? json_array() : NULL;
    if (!s)
        return NULL;
    sqlite3_bind_int64(s, 1, most);
    while (sqlite3_step(s) == SQLITE_ROW)
        json_array_append_new(works, json_pack("{so so so so so sI sb so}", "id", library_text(s, 0), "title",
                                               library_text(s, 1), "author", library_text(s, 2), "lang",
                                               library_text(s, 3), "date", library_text(s, 4), "sections",
                                               (json_int_t)sqlite3_column_int64(s, 5), "recording",
                                               sqlite3_column_int(s, 6), "updated",
                                               time_of(sqlite3_column_int64(s, 7))));
    sqlite3_finalize(s);
    return json_pack("{so}", "works", works);
}
