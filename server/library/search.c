/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/library_internal.h"
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    sqlite3_stmt *row, *shape, *beside;
    json_t *lines; /* parsed shapes, by the first row of their passage */
    struct answer_limit *limit;
};

struct match {
    size_t from, to;
};

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

/* Finds the matches of the snippet. */
static size_t find_matches(struct searching *s, const char *text, size_t size, const char *lang, bool verse,
                           struct match *matches) {
    struct word word;
    size_t count = 0, from, to = size;
    bool turkish = !strncmp(lang, "tr", 2);
    for (size_t at = 0; count < MARKS_MOST && at < to && words_next(text, size, turkish, &at, &word);)
        if (search_query_means(&s->query, s->reader->stems, lang, &word)) {
            if (!count)
                cut(text, size, verse, word.from, &from, &to);
            matches[count++] = (struct match){word.from, word.to};
        }
    return count;
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

/* Returns the passage's name; for a speaker's name or a stage direction that of the next passage, or the
 * previous one at the end of a section. */
static const char *name_of(struct searching *s, int64_t row) {
    if (*index_text(s->row, 2))
        return index_text(s->row, 2);
    sqlite3_reset(s->beside);
    sqlite3_bind_int64(s->beside, 1, row);
    return sqlite3_step(s->beside) == SQLITE_ROW ? index_text(s->beside, 0) : "";
}

static json_t *result_of(struct searching *s, int64_t row, double worth) {
    struct match matches[MARKS_MOST];
    const char *work = index_text(s->row, 0), *text = index_text(s->row, 7), *lang = index_text(s->row, 6);
    size_t size = (size_t)sqlite3_column_bytes(s->row, 7);
    int section = sqlite3_column_int(s->row, 1), kind = sqlite3_column_int(s->row, 3),
        part = sqlite3_column_int(s->row, 4);
    bool verse = kind == BLOCK_VERSE;
    size_t count = find_matches(s, text, size, lang, verse, matches);
    int64_t line = sqlite3_column_int64(s->row, 5);
    json_t *block = json_sprintf("%s:%d:%s", work, section, name_of(s, row)), *passage;
    for (size_t i = 0; verse && count && i < matches[0].from; i++)
        line += text[i] == '\n';
    passage = verse ? json_sprintf("%s:%d:l%lld", work, section, (long long)line) : json_incref(block);
    json_t *result = json_pack("{so ss so ss sf s{ss so so} s{so si so} sb so}", "passage", passage, "kind",
                               search_kinds[kind], "block", block, "lang", lang, "score", worth, "work", "id",
                               work, "title", library_text(s->row, 8), "author", library_text(s->row, 9),
                               "section", "id", json_sprintf("%s:%d", work, section), "number", section,
                               "title", library_text(s->row, 10), "recording", sqlite3_column_int(s->row, 11),
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
    struct shelf shelf = {0};
    unsigned limit, after;
    json_t *answer = NULL;
    if (library_number("limit", s->question->limit, 1, LIMIT_MOST, LIMIT_USUAL, &limit, e) ||
        library_number("after", s->question->after, 0, AFTER_MOST, 0, &after, e))
        return NULL;
    size_t end = (size_t)after + limit;
    if (!search_places_find(&places, &shelf, s->reader, &s->query, s->question, e) &&
        !search_places_rank(&places, &shelf, s->reader, &s->query, s->question, e))
        answer = json_pack("{so sI sb sb}", "results", gather(s, &places, limit, after), "total",
                           (json_int_t)places.total, "counted", places.counted, "ranked",
                           places.ranked == places.count);
    if (answer && places.count > end && end <= AFTER_MOST)
        json_object_set_new(answer, "next", json_sprintf("%zu", end));
    if (answer && s->question->facets) {
        json_object_set_new(answer, "query", json_string(s->question->query));
        json_object_set_new(answer, "facets", search_facets(&shelf));
        json_object_set_new(answer, "titles", search_titles(&shelf, &s->query, s->reader->stems));
    }
    shelf_free(&shelf);
    search_places_free(&places);
    return answer;
}

int search_question_read(struct search_query *query, struct index_reader *r,
                         const struct library_question *question, struct error *e) {
    static const char *const apart[] = {"speaker", "stage"}; /* columns of their own */
    struct query_options options = {r->stems, question->lang, NULL};
    if (!question->query)
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "q");
    for (size_t i = 0; question->kinds && i < sizeof apart / sizeof *apart; i++)
        if (!strcmp(question->kinds, apart[i]))
            options.only = apart[i];
    return search_query_read(query, question->query, &options, e);
}

json_t *library_search_json(struct index_reader *r, const struct library_question *question,
                            struct answer_limit *limit, struct error *e) {
    struct searching s = {.reader = r, .question = question, .limit = limit, .lines = json_object()};
    json_t *answer = NULL;
    /* a statement on a row keeps the read transaction open for the others: one state of the index, locked
     * once */
    sqlite3_stmt *transaction = library_prepare(r, "SELECT rules FROM made", e);
    if (transaction)
        sqlite3_step(transaction);
    s.shape = library_prepare(r, "SELECT shape, first_line FROM passage WHERE id = ?", e);
    s.row = library_prepare(
        r,
        "SELECT p.work, p.section, p.name, p.kind, p.part, p.first_line, p.lang, p.text, w.title, "
        "w.author, s.title, w.recording FROM passage p JOIN work w ON w.name = p.work JOIN section s "
        "ON s.work = p.work AND s.number = p.section WHERE p.id = ?",
        e);
    s.beside =
        library_prepare(r,
                        "SELECT p.name FROM passage p JOIN passage here ON here.id = ? WHERE p.work = "
                        "here.work AND p.section = "
                        "here.section AND p.name <> '' ORDER BY p.id < here.id, abs(p.id - here.id) LIMIT 1",
                        e);
    if (s.row && s.shape && s.beside && !search_question_read(&s.query, r, question, e))
        answer = run(&s, e);
    search_query_free(&s.query);
    sqlite3_finalize(transaction);
    sqlite3_finalize(s.beside);
    sqlite3_finalize(s.shape);
    sqlite3_finalize(s.row);
    json_decref(s.lines);
    return answer;
}
