/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/library_internal.h"
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Finds the rows that match a query, best first, in bounded time. */

/* Rows ranked against each other, the first in the library's order; the rest follow unranked. */
enum { PLACES_RANKED = 1000 };

/* The best rows are read again: a row with the query's words exactly as written scores up to twice as much
 * as one with other forms. */
enum { PLACES_READ = 40 };

struct search_place {
    int64_t row;
    double worth;
};

struct search_places {
    struct search_place *list;
    size_t count, cap;
};

/* a range of row ids */
struct stretch {
    int64_t first, last;
};

struct stretches {
    struct stretch *list;
    size_t count, cap;
};

static void add(struct stretches *all, int64_t first, int64_t last) {
    if (all->count && all->list[all->count - 1].last + 1 >= first) {
        all->list[all->count - 1].last = last;
        return;
    }
    all->list = mem_grow(all->list, &all->cap, all->count + 1, sizeof *all->list);
    all->list[all->count++] = (struct stretch){first, last};
}

/* Lists the rows of the works that the question selects. */
static int read_works(struct stretches *all, struct index_reader *r, const struct library_question *q,
                      struct error *e) {
    if (!q->work && !q->author) {
        add(all, 0, INT64_MAX - 1);
        return 0;
    }
    sqlite3_stmt *s = library_prepare(r, "SELECT name, author, first, last FROM work ORDER BY first", e);
    while (s && sqlite3_step(s) == SQLITE_ROW)
        if (search_list_has(q->work, index_text(s, 0), false) &&
            (!q->author || !strcmp(q->author, index_text(s, 1)) ||
             search_list_has(q->author, index_text(s, 1), false)))
            add(all, sqlite3_column_int64(s, 2), sqlite3_column_int64(s, 3));
    sqlite3_finalize(s);
    return s ? 0 : -1;
}

static bool speaks(sqlite3_stmt *langs, int64_t row, const char *wanted) {
    if (!wanted)
        return true;
    sqlite3_reset(langs);
    sqlite3_bind_int64(langs, 1, row);
    return sqlite3_step(langs) == SQLITE_ROW && search_list_has(wanted, index_text(langs, 0), true);
}

static int by_worth(const void *a, const void *b) {
    const struct search_place *x = a, *y = b;
    if (x->worth > y->worth || x->worth < y->worth)
        return x->worth > y->worth ? -1 : 1;
    return (x->row > y->row) - (x->row < y->row);
}

/* Counts the terms that the row contains exactly as written. */
static size_t count_written(sqlite3_stmt *text, int64_t row, const struct search_query *query) {
    struct word word;
    bool found[QUERY_TERMS_MAX] = {false};
    size_t count = 0;
    sqlite3_reset(text);
    sqlite3_bind_int64(text, 1, row);
    if (sqlite3_step(text) != SQLITE_ROW)
        return 0;
    bool turkish = !strncmp(index_text(text, 1), "tr", 2);
    size_t size = (size_t)sqlite3_column_bytes(text, 0);
    for (size_t at = 0; words_next(index_text(text, 0), size, turkish, &at, &word);)
        for (size_t i = 0; i < query->count; i++)
            if (!found[i] && query->terms[i].stem_count && search_term_written(&query->terms[i], &word)) {
                found[i] = true;
                count++;
            }
    return count;
}

static void prefer_written(struct search_places *p, struct index_reader *r,
                           const struct search_query *query) {
    size_t terms = 0;
    struct error e;
    for (size_t i = 0; i < query->count; i++)
        terms += query->terms[i].stem_count > 0;
    sqlite3_stmt *text = terms ? library_prepare(r, "SELECT text, lang FROM passage WHERE id = ?", &e) : NULL;
    size_t most = p->count < PLACES_READ ? p->count : PLACES_READ;
    for (size_t i = 0; text && i < most; i++)
        p->list[i].worth *= 1 + (double)count_written(text, p->list[i].row, query) / (double)terms;
    if (text && most)
        qsort(p->list, most, sizeof *p->list, by_worth);
    sqlite3_finalize(text);
}

/* Finds all ranked rows, and at least the first `wanted`, in the works and languages that the question
 * selects. *p must be zeroed. Returns -1 with *e ("bad-index"); an interruption by the progress handler is
 * not an error. */
static int search_places_find(struct search_places *p, struct index_reader *r,
                              const struct search_query *query, const struct library_question *q,
                              size_t wanted, struct error *e) {
    struct stretches works = {0};
    size_t most =
        wanted > PLACES_RANKED ? wanted : PLACES_RANKED + 1; /* one more shows whether others follow */
    sqlite3_stmt *langs = library_prepare(r, "SELECT lang FROM passage WHERE id = ?", e), *rows = NULL;
    int result = !langs || read_works(&works, r, q, e) ? -1 : 0, status = SQLITE_OK;
    if (!result)
        rows = library_prepare(
            r,
            "SELECT rowid, worth(found) FROM found WHERE found MATCH ? AND rowid BETWEEN ? AND ? "
            "ORDER BY rowid",
            e);
    for (size_t i = 0; rows && i < works.count && status == SQLITE_OK && p->count < most; i++) {
        sqlite3_bind_text(rows, 1, (char *)query->match.data, -1, SQLITE_STATIC);
        sqlite3_bind_int64(rows, 2, works.list[i].first);
        sqlite3_bind_int64(rows, 3, works.list[i].last);
        while (p->count < most && sqlite3_step(rows) == SQLITE_ROW) {
            int64_t row = sqlite3_column_int64(rows, 0);
            if (!speaks(langs, row, q->lang))
                continue;
            p->list = mem_grow(p->list, &p->cap, p->count + 1, sizeof *p->list);
            p->list[p->count++] = (struct search_place){row, sqlite3_column_double(rows, 1)};
        }
        status = sqlite3_reset(rows);
    }
    if (!rows)
        result = -1;
    else if (status != SQLITE_OK && status != SQLITE_INTERRUPT)
        result = error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(r->sql));
    if (p->count)
        qsort(p->list, p->count < PLACES_RANKED ? p->count : PLACES_RANKED, sizeof *p->list, by_worth);
    if (!result)
        prefer_written(p, r, query);
    sqlite3_finalize(rows);
    sqlite3_finalize(langs);
    free(works.list);
    return result;
}

static void search_places_free(struct search_places *p) {
    free(p->list);
    *p = (struct search_places){0};
}

enum {
    LIMIT_USUAL = 20,
    LIMIT_MOST = 100,
    AFTER_MOST = 10000,
    SNIPPET_BEFORE = 60, /* bytes */
    SNIPPET = 240,
    MARKS_MOST = 64,
};

struct searching {
    struct index_reader *reader;
    const struct library_question *question;
    struct search_query query;
    sqlite3_stmt *row, *shape;
    json_t *lines; /* parsed shapes, by the first row of their passage */
    struct answer_limit *limit;
};

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

/* Chooses the snippet's range: whole lines of verse, else whole words. */
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

/* Returns the lines of the passage that starts at row `first`, from its shape, which is parsed once. NULL:
 * none. */
static json_t *lines_of(struct searching *s, int64_t first, int64_t *first_line) {
    char key[24];
    snprintf(key, sizeof key, "%lld", (long long)first);
    json_t *known = json_object_get(s->lines, key);
    if (!known) {
        sqlite3_reset(s->shape);
        sqlite3_bind_int64(s->shape, 1, first);
        if (sqlite3_step(s->shape) != SQLITE_ROW)
            return NULL;
        json_t *shape = json_loads(index_text(s->shape, 0), 0, NULL);
        known = json_pack("{sO? sI}", "lines", json_object_get(shape, "lines"), "first",
                          (json_int_t)sqlite3_column_int64(s->shape, 1));
        json_decref(shape);
        json_object_set_new(s->lines, key, known);
    }
    *first_line = json_integer_value(json_object_get(known, "first"));
    return json_object_get(known, "lines");
}

/* Sets the edition's number of a line. */
static void set_line(struct searching *s, json_t *result, int64_t row, int part, int64_t line) {
    int64_t first = 0;
    json_t *lines = lines_of(s, row - part, &first);
    json_object_set(result, "n", json_object_get(json_array_get(lines, (size_t)(line - first)), "n"));
}

static json_t *result_of(struct searching *s, int64_t row, double worth) {
    static const char *const kinds[] = {"head", "paragraph", "line", "note", "", "", ""};
    struct match matches[MARKS_MOST];
    const char *work = index_text(s->row, 0), *text = index_text(s->row, 7), *lang = index_text(s->row, 6);
    size_t size = (size_t)sqlite3_column_bytes(s->row, 7);
    int section = sqlite3_column_int(s->row, 1), kind = sqlite3_column_int(s->row, 3),
        part = sqlite3_column_int(s->row, 4);
    size_t count = find_matches(s, text, size, lang, matches);
    int64_t line = sqlite3_column_int64(s->row, 5);
    json_t *block = json_sprintf("%s:%d:%s", work, section, index_text(s->row, 2)), *passage;
    bool verse = kind == BLOCK_VERSE;
    for (size_t i = 0; verse && count && i < matches[0].from; i++)
        line += text[i] == '\n';
    passage = verse ? json_sprintf("%s:%d:l%lld", work, section, (long long)line) : json_incref(block);
    json_t *result = json_pack("{so ss so ss sf s{ss so so} s{so si so} sb so}", "passage", passage, "kind",
                               kinds[kind], "block", block, "lang", lang, "score", worth, "work", "id", work,
                               "title", library_text(s->row, 8), "author", library_text(s->row, 9), "section",
                               "id", json_sprintf("%s:%d", work, section), "number", section, "title",
                               library_text(s->row, 10), "recording", sqlite3_column_int(s->row, 11),
                               "snippet", snippet(text, size, verse, matches, count, part > 0, false));
    if (verse)
        set_line(s, result, row, part, line);
    return result;
}

/* Describes the results from `after` on. */
static json_t *gather(struct searching *s, const struct search_places *places, unsigned limit,
                      unsigned after) {
    json_t *results = json_array();
    for (size_t i = after; i < places->count && i < (size_t)after + limit && !answer_is_late(s->limit); i++) {
        sqlite3_reset(s->row);
        sqlite3_bind_int64(s->row, 1, places->list[i].row);
        if (sqlite3_step(s->row) == SQLITE_ROW)
            json_array_append_new(results, result_of(s, places->list[i].row, places->list[i].worth));
    }
    return results;
}

static json_t *run(struct searching *s, struct error *e) {
    struct search_places places = {0};
    unsigned limit, after;
    json_t *answer = NULL;
    if (library_number("limit", s->question->limit, 1, LIMIT_MOST, LIMIT_USUAL, &limit, e) ||
        library_number("after", s->question->after, 0, AFTER_MOST, 0, &after, e))
        return NULL;
    size_t end = (size_t)after + limit;
    if (!search_places_find(&places, s->reader, &s->query, s->question, end + 1, e))
        answer = json_pack("{so sb}", "results", gather(s, &places, limit, after), "ranked",
                           places.count <= PLACES_RANKED);
    if (answer && places.count > end)
        json_object_set_new(answer, "next", json_sprintf("%zu", end));
    search_places_free(&places);
    return answer;
}

json_t *library_search_json(struct index_reader *r, const struct library_question *question,
                            struct answer_limit *limit, struct error *e) {
    if (!question->query) {
        error_plain_in_field(e, ERROR_MISSING_FIELD, "q");
        return NULL;
    }
    struct searching s = {.reader = r, .question = question, .limit = limit, .lines = json_object()};
    const struct query_options options = {r->stems, question->lang};
    json_t *answer = NULL;
    s.shape = library_prepare(r, "SELECT shape, first_line FROM passage WHERE id = ?", e);
    s.row = library_prepare(
        r,
        "SELECT p.work, p.section, p.name, p.kind, p.part, p.first_line, p.lang, p.text, w.title, "
        "w.author, s.title, w.recording FROM passage p JOIN work w ON w.name = p.work JOIN section s "
        "ON s.work = p.work AND s.number = p.section WHERE p.id = ?",
        e);
    if (s.row && s.shape && !search_query_read(&s.query, question->query, &options, e))
        answer = run(&s, e);
    search_query_free(&s.query);
    sqlite3_finalize(s.shape);
    sqlite3_finalize(s.row);
    json_decref(s.lines);
    return answer;
}
