/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A concordance: every occurrence of the searched words, in the library's order, with the text on both sides
 * (keyword in context). */
#include "server/base/utf8.h"
#include "server/library/library_internal.h"
#include <stdlib.h>
#include <string.h>

enum { LIMIT_USUAL = 50, LIMIT_MOST = 1000, WIDTH_USUAL = 60, WIDTH_MOST = 300 };

struct concordance {
    struct index_reader *reader;
    struct search_query query;
    sqlite3_stmt *row;
    json_t *lines;
    unsigned limit, width;
    int64_t row_after;    /* begins with this row, */
    unsigned match_after; /* after that many of its occurrences */
    char next[40];
};

/* Returns the byte of the character `width` characters before or after `at`, but within [0, size]. */
static size_t side(const char *text, size_t size, size_t at, unsigned width, bool before) {
    for (; width && (before ? at > 0 : at < size); width--) {
        at = before ? at - 1 : at + 1;
        while (before ? at > 0 && ((unsigned char)text[at] & 0xC0) == 0x80
                      : at < size && ((unsigned char)text[at] & 0xC0) == 0x80)
            at = before ? at - 1 : at + 1;
    }
    return at;
}

/* Returns text[from, to) on one line. */
static json_t *one_line(const char *text, size_t from, size_t to) {
    json_t *string;
    char *copy = strndup(text + from, to - from);
    for (char *at = copy; at && *at; at++)
        if (*at == '\n' || *at == '\r' || *at == '\t')
            *at = ' ';
    string = json_string(copy ? copy : "");
    free(copy);
    return string;
}

/* Adds the occurrences in the row. Returns false when there are enough; c->next tells where to go on. */
static bool add_row(struct concordance *c, const struct shelf_work *work, int64_t row) {
    const char *lang = index_text(c->row, 3), *text = index_text(c->row, 4);
    size_t size = (size_t)sqlite3_column_bytes(c->row, 4), line = (size_t)sqlite3_column_int64(c->row, 5),
           seen = 0;
    int section = sqlite3_column_int(c->row, 0), kind = sqlite3_column_int(c->row, 2);
    bool turkish = !strncmp(lang, "tr", 2);
    unsigned number = 0;
    struct word word;
    for (size_t at = 0; words_next(text, size, turkish, &at, &word);) {
        if (!search_query_means(&c->query, c->reader->stems, lang, &word) ||
            (row == c->row_after && number++ < c->match_after))
            continue;
        if (json_array_size(c->lines) == c->limit) {
            snprintf(c->next, sizeof c->next, "%lld.%u", (long long)row,
                     row == c->row_after ? number - 1 : number);
            return false;
        }
        number += row != c->row_after;
        for (; kind == BLOCK_VERSE && seen < word.from; seen++)
            line += text[seen] == '\n';
        json_t *passage = kind == BLOCK_VERSE
                              ? json_sprintf("%s:%d:l%zu", work->name, section, line)
                              : json_sprintf("%s:%d:%s", work->name, section, index_text(c->row, 1));
        json_array_append_new(
            c->lines,
            json_pack("{so so so so ss ss s{ss ss ss*}}", "left",
                      one_line(text, side(text, size, word.from, c->width, true), word.from), "match",
                      one_line(text, word.from, word.to), "right",
                      one_line(text, word.to, side(text, size, word.to, c->width, false)), "passage", passage,
                      "kind", search_kinds[kind], "lang", lang, "work", "id", work->name, "title",
                      work->title, "author", *work->author ? work->author : NULL));
    }
    return true;
}

static json_t *run(struct concordance *c, const struct library_question *q, struct answer_limit *limit,
                   struct error *e) {
    struct search_places places = {0};
    struct shelf shelf = {0};
    json_t *answer = NULL;
    if (!search_places_find(&places, &shelf, c->reader, &c->query, q, e)) {
        bool more = true;
        for (size_t i = 0; more && i < places.count && !answer_is_late(limit); i++) {
            if (places.list[i].row < c->row_after)
                continue;
            sqlite3_reset(c->row);
            sqlite3_bind_int64(c->row, 1, places.list[i].row);
            if (sqlite3_step(c->row) == SQLITE_ROW)
                more = add_row(c, &shelf.works[places.list[i].work], places.list[i].row);
        }
        answer = json_pack("{sO sI sb ss*}", "lines", c->lines, "total", (json_int_t)places.total, "counted",
                           places.counted, "next", *c->next ? c->next : NULL);
    }
    shelf_free(&shelf);
    search_places_free(&places);
    return answer;
}

/* Reads `after`: ROW.NUMBER, as in an earlier answer's `next`. */
static int read_after(struct concordance *c, const char *after, struct error *e) {
    char *dot = NULL, *end = NULL;
    if (!after)
        return 0;
    c->row_after = strtoll(after, &dot, 10);
    c->match_after = *dot == '.' ? (unsigned)strtoul(dot + 1, &end, 10) : 0;
    return c->row_after > 0 && end && !*end
               ? 0
               : error_in_field(e, ERROR_BAD_FIELD, "after", "is not the next of an earlier answer");
}

json_t *library_concordance_json(struct index_reader *r, const struct library_question *q,
                                 struct answer_limit *limit, struct error *e) {
    struct concordance c = {.reader = r, .lines = json_array()};
    json_t *answer = NULL;
    c.row =
        library_prepare(r, "SELECT section, name, kind, lang, text, first_line FROM passage WHERE id = ?", e);
    if (c.row && !search_question_read(&c.query, r, q, e) &&
        !library_number("limit", q->limit, 1, LIMIT_MOST, LIMIT_USUAL, &c.limit, e) &&
        !library_number("width", q->width, 1, WIDTH_MOST, WIDTH_USUAL, &c.width, e) &&
        !read_after(&c, q->after, e))
        answer = run(&c, q, limit, e);
    search_query_free(&c.query);
    sqlite3_finalize(c.row);
    json_decref(c.lines);
    return answer;
}
