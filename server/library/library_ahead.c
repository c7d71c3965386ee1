/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What who speaks the works ahead asks, and tells; and what is counted of that and of the alignments. */
#include "server/library/library_internal.h"
#include <string.h>

#define OF_LANG " FROM work WHERE (lang = ?1 OR lang LIKE ?1 || '-%') "

static const char *const states[] = {[LIBRARY_AHEAD_NONE] = "",
                                     [LIBRARY_AHEAD_WAITING] = "waiting",
                                     [LIBRARY_AHEAD_SPEAKING] = "speaking",
                                     [LIBRARY_AHEAD_RESTING] = "resting",
                                     [LIBRARY_AHEAD_DONE] = "done",
                                     [LIBRARY_AHEAD_FULL] = "full"};

uint64_t library_version(struct library *l) {
    pthread_mutex_lock(&l->mutex);
    uint64_t version = l->indexing ? 0 : l->signature;
    pthread_mutex_unlock(&l->mutex);
    return version;
}

/* A row about the works of a language: 1, 0, or -1 with *e. The statement is to be finalised when it is 1. */
static int row(struct index_reader *r, const char *sql, const char *lang, const char *after, sqlite3_stmt **s,
               struct error *e) {
    *s = library_prepare(r, sql, e);
    if (!*s)
        return -1;
    sqlite3_bind_text(*s, 1, lang, -1, SQLITE_STATIC);
    if (after)
        sqlite3_bind_text(*s, 2, after, -1, SQLITE_STATIC);
    if (sqlite3_step(*s) == SQLITE_ROW)
        return 1;
    sqlite3_finalize(*s);
    return 0;
}

int library_next_work(struct library *l, const char *lang, const char *after, struct library_place *out,
                      struct error *e) {
    char from[sizeof out->work];
    sqlite3_stmt *s;
    snprintf(from, sizeof from, "%s", after); /* which may lie in out */
    struct index_reader *r = library_reader(l, e);
    int found =
        r ? row(r, "SELECT name, sections" OF_LANG "AND name > ?2 ORDER BY name LIMIT 1", lang, from, &s, e)
          : -1;
    if (found > 0) {
        snprintf(out->work, sizeof out->work, "%s", (const char *)sqlite3_column_text(s, 0));
        out->sections = (unsigned)sqlite3_column_int64(s, 1);
        sqlite3_finalize(s);
    }
    if (r)
        library_reader_done(l, r);
    return found;
}

void library_sections(struct library *l, const char *lang, unsigned *out) {
    struct error e;
    sqlite3_stmt *s;
    struct index_reader *r = library_reader(l, &e);
    *out = 0;
    if (r && row(r, "SELECT coalesce(sum(sections), 0)" OF_LANG, lang, NULL, &s, &e) > 0) {
        *out = (unsigned)sqlite3_column_int64(s, 0);
        sqlite3_finalize(s);
    }
    if (r)
        library_reader_done(l, r);
}

void library_set_ahead(struct library *l, const struct library_ahead *ahead) {
    pthread_mutex_lock(&l->mutex);
    l->ahead = *ahead;
    pthread_mutex_unlock(&l->mutex);
}

static struct library_ahead ahead_of(struct library *l) {
    pthread_mutex_lock(&l->mutex);
    struct library_ahead ahead = l->ahead;
    pthread_mutex_unlock(&l->mutex);
    return ahead;
}

json_t *library_ahead_json(struct library *l) {
    const struct library_ahead a = ahead_of(l);
    return a.state == LIBRARY_AHEAD_NONE
               ? NULL
               : json_pack("{ss ss sI sI sI sI}", "voice", a.voice, "state", states[a.state], "done",
                           (json_int_t)a.done, "of", (json_int_t)a.of, "bytes", (json_int_t)a.bytes, "most",
                           (json_int_t)a.most);
}

void library_metrics(struct library *l, struct buf *out) {
    const struct library_ahead a = ahead_of(l);
    alignments_metrics(l->alignments, out);
    if (a.state == LIBRARY_AHEAD_NONE)
        return;
    buf_printf(out,
               "# HELP faccia_library_ahead_sections Sections of the library that are spoken ahead, and that "
               "are to be.\n# TYPE faccia_library_ahead_sections gauge\n"
               "faccia_library_ahead_sections{which=\"done\"} %u\n"
               "faccia_library_ahead_sections{which=\"all\"} %u\n"
               "# HELP faccia_library_ahead_bytes Bytes of sound that were spoken ahead.\n"
               "# TYPE faccia_library_ahead_bytes gauge\nfaccia_library_ahead_bytes %llu\n",
               a.done, a.of, (unsigned long long)a.bytes);
}
