/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/json/error_json.h"
#include "server/library/cast.h"
#include "server/library/library_internal.h"
#include "server/library/recordings/alignments.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- the newest works, for feeds and sitemaps ---- */

enum { NS = 1000000000 };

/* Formats a time as RFC 3339 in UTC. */
static json_t *time_of(int64_t ns) {
    char text[32];
    struct tm utc;
    time_t seconds = (time_t)(ns / NS);
    gmtime_r(&seconds, &utc);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return json_string(text);
}

static json_t *library_newest_json(struct index_reader *r, unsigned most, struct error *e) {
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

/* ---- lists and works ---- */

enum {
    LIST_USUAL = 200,
    LIST_MOST = 1000,
    SEARCH_MS = 2000,
    ANSWER_MS = 10000,      /* every other answer is read straight from the index */
    LOOK_OPERATIONS = 2000, /* virtual machine instructions between two checks of the clock */
};

static int on_progress(void *limit) {
    return answer_is_late(limit);
}

/* Columns of a work up to `recording`, in this order. */
#define WORK_COLUMNS                                                                                         \
    "name, title, author, lang, date, publisher, licence, source, format, path, hash, sections, passages, "  \
    "characters, "                                                                                           \
    "recording"

static json_t *work_of(sqlite3_stmt *s, bool whole) {
    static const char *const names[] = {"id",      "title",  "author", "lang", "date", "publisher",
                                        "licence", "source", "format", "file", "hash"};
    static const char *const counts[] = {"sections", "passages", "characters"};
    json_t *work = json_object();
    for (int i = 0; i < 11; i++)
        if (whole || i < 5 || i > 7)
            json_object_set_new(work, names[i], library_text(s, i));
    for (int i = whole; i < 3; i++)
        json_object_set_new(work, counts[i], json_integer(sqlite3_column_int64(s, 11 + i)));
    json_object_set_new(work, "recording", json_boolean(sqlite3_column_int(s, 14)));
    return work;
}

static json_t *strings(struct index_reader *r, const char *sql, struct error *e) {
    sqlite3_stmt *s = library_prepare(r, sql, e);
    json_t *list = s ? json_array() : NULL;
    while (s && sqlite3_step(s) == SQLITE_ROW)
        json_array_append_new(list, library_text(s, 0));
    sqlite3_finalize(s);
    return list;
}

static json_t *problems(struct index_reader *r, struct error *e) {
    sqlite3_stmt *s = library_prepare(
        r, "SELECT code, path, line, col, message, serious FROM problem ORDER BY path, rowid LIMIT 200", e);
    json_t *list = s ? json_array() : NULL;
    while (s && sqlite3_step(s) == SQLITE_ROW) {
        json_t *problem = json_pack("{so so so sb}", "code", library_text(s, 0), "file", library_text(s, 1),
                                    "message", library_text(s, 4), "serious", sqlite3_column_int(s, 5));
        if (sqlite3_column_int64(s, 2)) {
            json_object_set_new(problem, "line", json_integer(sqlite3_column_int64(s, 2)));
            json_object_set_new(problem, "column", json_integer(sqlite3_column_int64(s, 3)));
        }
        json_array_append_new(list, problem);
    }
    sqlite3_finalize(s);
    return list;
}

static json_t *listed(struct library *l, sqlite3_stmt *s) {
    json_t *work = work_of(s, false);
    const char *state = alignments_state(l->alignments, json_string_value(json_object_get(work, "id")));
    if (state)
        json_object_set_new(work, "alignment", json_string(state));
    return work;
}

static json_t *list_works(struct library *l, struct index_reader *r, const struct library_question *q,
                          struct error *e) {
    unsigned limit;
    if (library_number("limit", q->limit, 1, LIST_MOST, LIST_USUAL, &limit, e))
        return NULL;
    sqlite3_stmt *s =
        library_prepare(r, "SELECT " WORK_COLUMNS " FROM work WHERE name > ? ORDER BY name LIMIT ?", e);
    sqlite3_stmt *sum = s ? library_prepare(r, "SELECT coalesce(sum(characters), 0) FROM work", e) : NULL;
    json_t *languages = sum ? strings(r, "SELECT DISTINCT lang FROM work ORDER BY lang", e) : NULL;
    json_t *authors =
        languages
            ? strings(r,
                      "SELECT DISTINCT author FROM work WHERE author IS NOT NULL ORDER BY author LIMIT 1000",
                      e)
            : NULL;
    json_t *told = authors ? problems(r, e) : NULL, *answer = NULL;
    if (told) {
        json_t *works = json_array(), *next = NULL;
        sqlite3_bind_text(s, 1, q->after ? q->after : "", -1, SQLITE_STATIC);
        sqlite3_bind_int64(s, 2, (int64_t)limit + 1);
        while (sqlite3_step(s) == SQLITE_ROW)
            json_array_append_new(works, listed(l, s));
        if (json_array_size(works) > limit) {
            json_array_remove(works, limit);
            next = json_incref(json_object_get(json_array_get(works, limit - 1), "id"));
        }
        json_t *ahead = library_prerender_json(l);
        sqlite3_step(sum);
        pthread_mutex_lock(&l->mutex);
        answer =
            json_pack("{ss sI sI sO sO sI so* so* so sO}", "state", l->indexing ? "indexing" : "ready",
                      "done", (json_int_t)l->done, "of", (json_int_t)l->of, "languages", languages, "authors",
                      authors, "characters", (json_int_t)sqlite3_column_int64(sum, 0), "alignment",
                      alignments_summary(l->alignments), "ahead", ahead, "works", works, "problems", told);
        pthread_mutex_unlock(&l->mutex);
        if (next)
            json_object_set_new(answer, "next", next);
    }
    json_decref(languages);
    json_decref(authors);
    json_decref(told);
    sqlite3_finalize(s);
    sqlite3_finalize(sum);
    return answer;
}

/* An array with the work's recording, or an empty one. */
static json_t *recordings(struct library *l, const char *work) {
    json_t *recording = alignments_recording(l->alignments, work, 0), *list = json_array();
    if (recording)
        json_array_append_new(list, recording);
    return list;
}

static json_t *describe_work(struct library *l, struct index_reader *r, const char *name, struct error *e) {
    sqlite3_stmt *s = library_prepare(r, "SELECT " WORK_COLUMNS " FROM work WHERE name = ?", e);
    json_t *answer = NULL;
    if (s)
        sqlite3_bind_text(s, 1, name, -1, SQLITE_STATIC);
    if (s && sqlite3_step(s) == SQLITE_ROW)
        answer = work_of(s, true);
    else if (s)
        error_in_field(e, ERROR_UNKNOWN_WORK, "work", "unknown work '%.80s'", name);
    sqlite3_finalize(s);
    s = answer ? library_prepare(
                     r,
                     "SELECT number, title, level, passages, characters FROM section WHERE work = ? ORDER "
                     "BY number",
                     e)
               : NULL;
    if (answer && !s) {
        json_decref(answer);
        return NULL;
    }
    json_t *sections = json_array();
    if (s)
        sqlite3_bind_text(s, 1, name, -1, SQLITE_STATIC);
    while (s && sqlite3_step(s) == SQLITE_ROW)
        json_array_append_new(sections,
                              json_pack("{so sI so sI sI sI sO}", "id",
                                        json_sprintf("%s:%lld", name, (long long)sqlite3_column_int64(s, 0)),
                                        "number", (json_int_t)sqlite3_column_int64(s, 0), "title",
                                        library_text(s, 1), "level", (json_int_t)sqlite3_column_int64(s, 2),
                                        "passages", (json_int_t)sqlite3_column_int64(s, 3), "characters",
                                        (json_int_t)sqlite3_column_int64(s, 4), "recording",
                                        json_object_get(answer, "recording")));
    sqlite3_finalize(s);
    if (answer) {
        json_object_set_new(answer, "recordings", recordings(l, name));
        json_object_set(answer, "sections", sections);
    }
    json_decref(sections);
    return answer;
}

static json_t *describe_cast(struct library *l, struct index_reader *r, const struct library_question *q,
                             struct error *e) {
    struct cast cast;
    json_t *answer = NULL;
    if (!library_cast_of(l, r, q->work, q->offer, &cast, e)) {
        answer = cast_json(&cast);
        json_object_set_new(answer, "work", json_string(q->work));
    }
    cast_free(&cast);
    return answer;
}

int library_answer(struct library *l, const struct library_question *asked, struct buf *out,
                   struct error *e) {
    struct index_reader *r = library_reader(l, e);
    struct library_question current = *asked, *q = &current;
    const bool searches = q->kind == LIBRARY_SEARCH || q->kind == LIBRARY_CONCORDANCE;
    struct answer_limit limit = answer_limit_in(searches ? SEARCH_MS : ANSWER_MS, q->given_up);
    json_t *answer = NULL;
    if (!r)
        return -1;
    sqlite3_progress_handler(r->sql, LOOK_OPERATIONS, on_progress, &limit);
    sqlite3_exec(r->sql, "BEGIN", NULL, NULL, NULL); /* one consistent snapshot */
    char *work = q->work && !searches ? library_current(r, q->work) : NULL,
         *passage = q->passage ? library_current(r, q->passage) : NULL;
    q->work = work ? work : q->work;
    q->passage = passage;
    switch (q->kind) {
    case LIBRARY_LIST:
        answer = list_works(l, r, q, e);
        break;
    case LIBRARY_WORK:
        answer = describe_work(l, r, q->work, e);
        break;
    case LIBRARY_CAST:
        answer = describe_cast(l, r, q, e);
        break;
    case LIBRARY_SECTION:
        answer = library_section_json(l, r, q->work, q->section, e);
        break;
    case LIBRARY_PASSAGE:
        answer = library_passage_json(r, q, e);
        break;
    case LIBRARY_SEARCH:
        answer = library_search_json(r, q, &limit, e);
        break;
    case LIBRARY_CONCORDANCE:
        answer = library_concordance_json(r, q, &limit, e);
        break;
    case LIBRARY_NEWEST:
        answer = library_newest_json(r, q->most, e);
    }
    free(work);
    free(passage);
    sqlite3_progress_handler(r->sql, 0, NULL, NULL);
    library_reader_look(r);
    sqlite3_exec(r->sql, "COMMIT", NULL, NULL, NULL);
    const bool damaged = r->damaged;
    library_reader_done(l, r);
    if (damaged) { /* the answer may be incomplete */
        json_decref(answer);
        return error_plain(e, ERROR_BAD_INDEX);
    }
    if (limit.late) { /* the answer is incomplete */
        json_decref(answer);
        return searches ? error_plain(e, ERROR_SEARCH_TOO_LONG)
                        : error_set(e, ERROR_SEARCH_TOO_LONG, "the answer takes longer than %d s",
                                    ANSWER_MS / 1000);
    }
    if (answer)
        json_print(out, answer, JSON_COMPACT | JSON_REAL_PRECISION(6));
    json_decref(answer);
    return answer ? 0 : -1;
}
