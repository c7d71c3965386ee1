/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/library.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/directions.h"
#include "server/library/library_internal.h"
#include "server/library/work_lexicons.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static uint64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000 + (uint64_t)t.tv_nsec / 1000000;
}

struct answer_limit answer_limit_in(unsigned ms, const atomic_bool *given_up) {
    return (struct answer_limit){given_up, now() + ms, false};
}

bool answer_is_late(struct answer_limit *limit) {
    limit->late = limit->late || (limit->given_up && atomic_load(limit->given_up)) || now() > limit->until;
    return limit->late;
}

void library_reader_look(struct index_reader *r) {
    r->damaged = r->damaged || index_is_damaged(r->sql);
}

sqlite3_stmt *library_prepare(struct index_reader *r, const char *sql, struct error *e) {
    sqlite3_stmt *s = NULL;
    library_reader_look(r);
    if (sqlite3_prepare_v2(r->sql, sql, -1, &s, NULL) != SQLITE_OK)
        error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(r->sql));
    library_reader_look(r);
    return s;
}

char *library_current(struct index_reader *r, const char *place) {
    static const char sql[] =
        "SELECT name FROM work WHERE name = ?1 UNION ALL SELECT w.name FROM former f JOIN work "
        "w ON w.hash = f.hash WHERE f.work = ?1 LIMIT 1";
    struct error e;
    size_t size = strcspn(place, ":");
    char *current = NULL;
    sqlite3_stmt *s = library_prepare(r, sql, &e);
    if (s) {
        sqlite3_bind_text(s, 1, place, (int)size, SQLITE_STATIC);
        if (sqlite3_step(s) == SQLITE_ROW) {
            const char *name = index_text(s, 0);
            size_t room = strlen(name) + strlen(place + size) + 1;
            current = mem_alloc(room);
            snprintf(current, room, "%s%s", name, place + size);
        }
    }
    sqlite3_finalize(s);
    return current ? current : mem_strdup(place);
}

json_t *library_text(sqlite3_stmt *s, int column) {
    const char *text = (const char *)sqlite3_column_text(s, column);
    json_t *string = text ? json_string(text) : NULL;
    return string ? string : json_null();
}

int library_number(const char *field, const char *text, unsigned min, unsigned max, unsigned otherwise,
                   unsigned *out, struct error *e) {
    char *end;
    unsigned long value = text ? strtoul(text, &end, 10) : otherwise;
    if (text && (*text < '0' || *text > '9' || *end || value < min || value > max))
        return error_in_field(e, ERROR_BAD_FIELD, field, "must be an integer from %u to %u", min, max);
    *out = (unsigned)value;
    return 0;
}

struct library *library_open(const struct library_options *options, struct error *e) {
    struct index_writer writer;
    struct stat info;
    if (stat(options->folder, &info) || !S_ISDIR(info.st_mode)) {
        error_in_field(e, ERROR_BAD_WORK, "--library", "%.150s: %.80s", options->folder,
                       strerror(stat(options->folder, &info) ? errno : ENOTDIR));
        return NULL;
    }
    struct index_rules rules = {.spellings = spellings_load(options->spellings, e)};
    rules.directions = rules.spellings ? directions_load(options->directions, e) : NULL;
    /* index_open creates or repairs it before the first reader opens it */
    if (!rules.directions || index_open(&writer, options->index, &rules, e)) {
        spellings_free(rules.spellings);
        directions_free(rules.directions);
        return NULL;
    }
    index_close(&writer);
    struct library *l = mem_alloc(sizeof *l);
    l->rules = rules;
    l->folder = mem_strdup(options->folder);
    l->index = mem_strdup(options->index);
    l->voices = options->voices ? mem_strdup(options->voices) : NULL;
    l->lang = mem_strdup(options->lang);
    l->reader = (struct reader){options->reader.program ? mem_strdup(options->reader.program) : NULL,
                                options->reader.unconfined};
    l->indexing = true;
    if (l->voices)
        l->alignments = alignments_open(l->folder, l->voices, l->lang, &options->aligner, &l->reader);
    pthread_mutex_init(&l->mutex, NULL);
    pthread_cond_init(&l->wake, NULL);
    if (!pthread_create(&l->thread, NULL, library_scan, l))
        return l;
    error_set(e, ERROR_BAD_INDEX, "cannot start a thread");
    l->thread = 0;
    library_close(l);
    return NULL;
}

void library_look(struct library *l) {
    pthread_mutex_lock(&l->mutex);
    l->look = true;
    pthread_cond_broadcast(&l->wake);
    pthread_mutex_unlock(&l->mutex);
}

static void close_reader(struct index_reader *r) {
    sqlite3_close(r->sql);
    stems_close(r->stems);
    free(r);
}

void library_close(struct library *l) {
    if (!l)
        return;
    atomic_store(&l->stop, true);
    pthread_mutex_lock(&l->mutex);
    l->closing = true;
    pthread_cond_broadcast(&l->wake);
    pthread_mutex_unlock(&l->mutex);
    if (l->thread)
        pthread_join(l->thread, NULL);
    alignments_close(l->alignments);
    work_lexicons_free(l);
    common_rows_release(l->common);
    for (unsigned i = 0; i < l->idle_count; i++)
        close_reader(l->idle[i]);
    pthread_mutex_destroy(&l->mutex);
    pthread_cond_destroy(&l->wake);
    free(l->folder);
    free(l->index);
    free(l->lang);
    free(l->voices);
    spellings_free(l->rules.spellings);
    directions_free(l->rules.directions);
    free((char *)l->reader.program);
    free(l);
}

struct index_reader *library_reader(struct library *l, struct error *e) {
    struct index_reader *r = NULL;
    pthread_mutex_lock(&l->mutex);
    if (l->idle_count)
        r = l->idle[--l->idle_count];
    struct common_rows *common = common_rows_keep(l->common);
    const unsigned generation = l->generation;
    pthread_mutex_unlock(&l->mutex);
    if (r && r->generation == generation) {
        r->common = common;
        return r;
    }
    if (r)
        close_reader(r);
    sqlite3 *sql = index_open_reader(l->index);
    if (!sql) {
        common_rows_release(common);
        error_plain(e, ERROR_BAD_INDEX);
        return NULL;
    }
    r = mem_alloc(sizeof *r);
    *r = (struct index_reader){sql, stems_open(l->rules.spellings), generation, false, common};
    return r;
}

void library_reader_done(struct library *l, struct index_reader *r) {
    common_rows_release(r->common);
    r->common = NULL;
    pthread_mutex_lock(&l->mutex);
    bool current = r->generation == l->generation;
    bool kept = l->idle_count < READERS_MAX && current && !r->damaged;
    if (r->damaged && current) {
        atomic_store(&l->damaged, true);
        pthread_cond_broadcast(&l->wake);
    }
    if (kept)
        l->idle[l->idle_count++] = r;
    pthread_mutex_unlock(&l->mutex);
    if (!kept)
        close_reader(r);
}

/* For the prerenderer: works of one language and its progress; and the metrics. */

#define OF_LANG " FROM work WHERE (lang = ?1 OR lang LIKE ?1 || '-%') "

static const char *const states[] = {
    [PRERENDER_NONE] = "",           [PRERENDER_WAITING] = "waiting", [PRERENDER_SPEAKING] = "speaking",
    [PRERENDER_RESTING] = "resting", [PRERENDER_DONE] = "done",       [PRERENDER_FULL] = "full"};

uint64_t library_version(struct library *l) {
    pthread_mutex_lock(&l->mutex);
    uint64_t version = l->indexing ? 0 : l->signature;
    pthread_mutex_unlock(&l->mutex);
    return version;
}

/* Reads a row about the works of a language. 1: found, and the caller finalises *s; 0: none; -1 with *e. */
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
    snprintf(from, sizeof from, "%s", after); /* `after` may point into *out */
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

void library_set_prerender(struct library *l, const struct library_prerender *p) {
    pthread_mutex_lock(&l->mutex);
    l->prerender = *p;
    pthread_mutex_unlock(&l->mutex);
}

static struct library_prerender prerender_of(struct library *l) {
    pthread_mutex_lock(&l->mutex);
    struct library_prerender p = l->prerender;
    pthread_mutex_unlock(&l->mutex);
    return p;
}

json_t *library_prerender_json(struct library *l) {
    const struct library_prerender a = prerender_of(l);
    return a.state == PRERENDER_NONE
               ? NULL
               : json_pack("{ss ss sI sI sI sI}", "voice", a.voice, "state", states[a.state], "done",
                           (json_int_t)a.done, "of", (json_int_t)a.of, "bytes", (json_int_t)a.bytes, "most",
                           (json_int_t)a.most);
}

void library_metrics(struct library *l, struct buf *out) {
    const struct library_prerender a = prerender_of(l);
    alignments_metrics(l->alignments, out);
    if (a.state == PRERENDER_NONE)
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
