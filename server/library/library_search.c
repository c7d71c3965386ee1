/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include "server/library/library_internal.h"
#include "server/library/search_query.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    LIMIT_USUAL = 20,
    LIMIT_MOST = 100,
    AFTER_MOST = 10000,
    SEARCH_MS = 2000,
    LOOK_OPERATIONS = 2000, /* of SQLite's machine, between two looks at the clock */
    SNIPPET_BEFORE = 60,    /* bytes */
    SNIPPET = 240,
    MARKS_MOST = 64,
};

struct searching {
    struct index_reader *reader;
    const struct library_question *question;
    struct search_query query;
    sqlite3_stmt *common, *row, *shape;
    uint64_t until; /* ms */
    bool late;
};

static uint64_t now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000 + (uint64_t)t.tv_nsec / 1000000;
}

static int on_progress(void *ctx) {
    struct searching *s = ctx;
    s->late = now() > s->until;
    return s->late;
}

static bool is_common(void *ctx, const char *term, bool stem) {
    struct searching *s = ctx;
    sqlite3_reset(s->common);
    sqlite3_bind_text(s->common, 1, term, -1, SQLITE_TRANSIENT);
    sqlite3_bind_text(s->common, 2, stem ? "stem" : "word", -1, SQLITE_STATIC);
    bool is = sqlite3_step(s->common) == SQLITE_ROW;
    sqlite3_reset(s->common);
    return is;
}

static const char *text_at(sqlite3_stmt *s, int column) {
    const char *text = (const char *)sqlite3_column_text(s, column);
    return text ? text : "";
}

static bool wanted(const struct searching *s) {
    const struct library_question *q = s->question;
    return search_list_has(q->work, text_at(s->row, 0), false) &&
           search_list_has(q->lang, text_at(s->row, 6), true) &&
           (!q->author || !strcmp(q->author, text_at(s->row, 9)) ||
            search_list_has(q->author, text_at(s->row, 9), false));
}

struct match {
    size_t from, to;
};

static size_t find_matches(struct searching *s, const char *text, size_t size, const char *lang,
                           struct match *matches) {
    struct word word;
    size_t count = 0;
    bool turkish = !strncmp(lang, "tr", 2);
    for (size_t at = 0; count < MARKS_MOST && words_next(text, size, turkish, &at, &word);)
        if (search_query_means(&s->query, s->reader->stems, lang, &word))
            matches[count++] = (struct match){word.from, word.to};
    return count;
}

/* Where the snippet begins and ends: at lines of verses, else between words. */
static void cut(const char *text, size_t size, bool verse, size_t match, size_t *from, size_t *to) {
    char edge = verse ? '\n' : ' ';
    *from = match > SNIPPET_BEFORE ? match - SNIPPET_BEFORE : 0;
    while (*from && text[*from - 1] != edge)
        (*from)--;
    *to = match + SNIPPET < size ? match + SNIPPET : size;
    while (*to < size && text[*to] != edge)
        (*to)++;
}

static json_t *snippet(const char *text, size_t size, bool verse, const struct match *matches, size_t count,
                       bool more_before, bool more_after) {
    size_t from, to;
    struct utf16_counter counter = {0};
    cut(text, size, verse, count ? matches[0].from : 0, &from, &to);
    json_t *marks = json_array();
    for (size_t i = 0; i < count && matches[i].to <= to; i++) {
        size_t start = utf16_offset(&counter, text + from, matches[i].from - from);
        json_array_append_new(
            marks, json_pack("[II]", (json_int_t)start,
                             (json_int_t)utf16_offset(&counter, text + from, matches[i].to - from)));
    }
    return json_pack("{so so sb sb}", "text", json_stringn(text + from, to - from), "marks", marks, "before",
                     from > 0 || more_before, "after", to < size || more_after);
}

/* The number of a line as the edition has it. */
static void set_line(struct searching *s, json_t *result, int64_t row, int part, int64_t line) {
    sqlite3_reset(s->shape);
    sqlite3_bind_int64(s->shape, 1, row - part);
    if (sqlite3_step(s->shape) != SQLITE_ROW)
        return;
    json_t *shape = json_loads(text_at(s->shape, 0), 0, NULL);
    json_t *one =
        json_array_get(json_object_get(shape, "lines"), (size_t)(line - sqlite3_column_int64(s->shape, 1)));
    json_object_set(result, "n", json_object_get(one, "n"));
    json_decref(shape);
}

static json_t *result_of(struct searching *s, int64_t row, double rank) {
    static const char *const kinds[] = {"head", "paragraph", "line", "note", "", "", ""};
    struct match matches[MARKS_MOST];
    const char *work = text_at(s->row, 0), *text = text_at(s->row, 7), *lang = text_at(s->row, 6);
    size_t size = (size_t)sqlite3_column_bytes(s->row, 7);
    int section = sqlite3_column_int(s->row, 1), kind = sqlite3_column_int(s->row, 3),
        part = sqlite3_column_int(s->row, 4);
    size_t count = find_matches(s, text, size, lang, matches);
    int64_t line = sqlite3_column_int64(s->row, 5);
    json_t *block = json_sprintf("%s:%d:%s", work, section, text_at(s->row, 2)), *passage;
    bool verse = kind == BLOCK_VERSE;
    for (size_t i = 0; verse && count && i < matches[0].from; i++)
        line += text[i] == '\n';
    passage = verse ? json_sprintf("%s:%d:l%lld", work, section, (long long)line) : json_incref(block);
    json_t *result = json_pack("{so ss so ss sf s{ss so so} s{so si so} sb so}", "passage", passage, "kind",
                               kinds[kind], "block", block, "lang", lang, "score", -rank, "work", "id", work,
                               "title", library_text(s->row, 8), "author", library_text(s->row, 9), "section",
                               "id", json_sprintf("%s:%d", work, section), "number", section, "title",
                               library_text(s->row, 10), "recording", sqlite3_column_int(s->row, 11),
                               "snippet", snippet(text, size, verse, matches, count, part > 0, false));
    if (verse)
        set_line(s, result, row, part, line);
    return result;
}

/* The rows that match, best first, from `after` on: one more than `limit` tells that there are more. */
static json_t *gather(struct searching *s, sqlite3_stmt *rows, unsigned limit, unsigned after, bool *more) {
    const struct library_question *q = s->question;
    bool all = !q->work && !q->lang && !q->author;
    json_t *results = json_array();
    unsigned seen = 0;
    *more = false;
    while (sqlite3_step(rows) == SQLITE_ROW && !*more) {
        int64_t row = sqlite3_column_int64(rows, 0);
        if (all && seen < after) {
            seen++;
            continue;
        }
        sqlite3_reset(s->row);
        sqlite3_bind_int64(s->row, 1, row);
        if (sqlite3_step(s->row) != SQLITE_ROW || !wanted(s) || seen++ < after)
            continue;
        if (json_array_size(results) == limit)
            *more = true;
        else
            json_array_append_new(results, result_of(s, row, sqlite3_column_double(rows, 1)));
    }
    return results;
}

static json_t *run(struct searching *s, struct error *e) {
    static const char ranked[] =
        "SELECT rowid, rank FROM found WHERE found MATCH ? AND rank MATCH 'bm25(2.0, 1.0)' "
        "ORDER BY rank",
                      plain[] = "SELECT rowid, 0 FROM found WHERE found MATCH ? ORDER BY rowid";
    unsigned limit, after;
    bool more;
    if (library_number("limit", s->question->limit, 1, LIMIT_MOST, LIMIT_USUAL, &limit, e) ||
        library_number("after", s->question->after, 0, AFTER_MOST, 0, &after, e))
        return NULL;
    sqlite3_stmt *rows = library_prepare(s->reader, s->query.ranked ? ranked : plain, e);
    if (!rows)
        return NULL;
    sqlite3_bind_text(rows, 1, (char *)s->query.match.data, -1, SQLITE_STATIC);
    json_t *results = gather(s, rows, limit, after, &more), *answer = NULL;
    int status = sqlite3_finalize(rows);
    if (s->late)
        error_plain(e, ERROR_SEARCH_TOO_LONG);
    else if (status != SQLITE_OK)
        error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(s->reader->sql));
    else
        answer = json_pack("{sO sb}", "results", results, "ranked", s->query.ranked);
    if (answer && more)
        json_object_set_new(answer, "next", json_sprintf("%u", after + limit));
    json_decref(results);
    return answer;
}

json_t *library_search_json(struct index_reader *r, const struct library_question *question,
                            struct error *e) {
    struct searching s = {.reader = r, .question = question, .until = now() + SEARCH_MS};
    const struct query_options options = {r->stems, question->lang, is_common, &s};
    json_t *answer = NULL;
    if (!question->query) {
        error_plain_in_field(e, ERROR_MISSING_FIELD, "q");
        return NULL;
    }
    s.common = library_prepare(r, "SELECT 1 FROM common WHERE term = ? AND col = ?", e);
    s.shape = library_prepare(r, "SELECT shape, first_line FROM passage WHERE id = ?", e);
    s.row = library_prepare(
        r,
        "SELECT p.work, p.section, p.name, p.kind, p.part, p.first_line, p.lang, p.text, w.title, "
        "w.author, s.title, w.recording FROM passage p JOIN work w ON w.name = p.work JOIN section s "
        "ON s.work = p.work AND s.number = p.section WHERE p.id = ?",
        e);
    sqlite3_progress_handler(r->sql, LOOK_OPERATIONS, on_progress, &s);
    if (s.common && s.row && s.shape && !search_query_read(&s.query, question->query, &options, e))
        answer = run(&s, e);
    sqlite3_progress_handler(r->sql, 0, NULL, NULL);
    search_query_free(&s.query);
    sqlite3_finalize(s.common);
    sqlite3_finalize(s.shape);
    sqlite3_finalize(s.row);
    return answer;
}
