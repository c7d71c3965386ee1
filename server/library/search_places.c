/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/search_places.h"
#include "server/base/mem.h"
#include "server/library/search_query.h"
#include <stdlib.h>
#include <string.h>

/* Rows that follow each other. */
struct stretch {
    int64_t first, last;
};

struct stretches {
    struct stretch *list;
    size_t count, cap;
};

static const char *text_at(sqlite3_stmt *s, int column) {
    const char *text = (const char *)sqlite3_column_text(s, column);
    return text ? text : "";
}

static void add(struct stretches *all, int64_t first, int64_t last) {
    if (all->count && all->list[all->count - 1].last + 1 >= first) {
        all->list[all->count - 1].last = last;
        return;
    }
    all->list = mem_grow(all->list, &all->cap, all->count + 1, sizeof *all->list);
    all->list[all->count++] = (struct stretch){first, last};
}

/* The works that the question names; all when it names none. */
static int read_works(struct stretches *all, struct index_reader *r, const struct library_question *q,
                      struct error *e) {
    if (!q->work && !q->author) {
        add(all, 0, INT64_MAX - 1);
        return 0;
    }
    sqlite3_stmt *s = library_prepare(r, "SELECT name, author, first, last FROM work ORDER BY first", e);
    while (s && sqlite3_step(s) == SQLITE_ROW)
        if (search_list_has(q->work, text_at(s, 0), false) &&
            (!q->author || !strcmp(q->author, text_at(s, 1)) ||
             search_list_has(q->author, text_at(s, 1), false)))
            add(all, sqlite3_column_int64(s, 2), sqlite3_column_int64(s, 3));
    sqlite3_finalize(s);
    return s ? 0 : -1;
}

static bool speaks(sqlite3_stmt *langs, int64_t row, const char *wanted) {
    if (!wanted)
        return true;
    sqlite3_reset(langs);
    sqlite3_bind_int64(langs, 1, row);
    return sqlite3_step(langs) == SQLITE_ROW && search_list_has(wanted, text_at(langs, 0), true);
}

static int by_worth(const void *a, const void *b) {
    const struct search_place *x = a, *y = b;
    if (x->worth > y->worth || x->worth < y->worth)
        return x->worth > y->worth ? -1 : 1;
    return (x->row > y->row) - (x->row < y->row);
}

/* How many of the terms that may have other forms stand there as they are written. */
static size_t count_written(sqlite3_stmt *text, int64_t row, const struct search_query *query) {
    struct word word;
    bool found[QUERY_TERMS_MAX] = {false};
    size_t count = 0;
    sqlite3_reset(text);
    sqlite3_bind_int64(text, 1, row);
    if (sqlite3_step(text) != SQLITE_ROW)
        return 0;
    bool turkish = !strncmp(text_at(text, 1), "tr", 2);
    size_t size = (size_t)sqlite3_column_bytes(text, 0);
    for (size_t at = 0; words_next(text_at(text, 0), size, turkish, &at, &word);)
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

int search_places_find(struct search_places *p, struct index_reader *r, const struct search_query *query,
                       const struct library_question *q, size_t wanted, struct error *e) {
    struct stretches works = {0};
    size_t most =
        wanted > PLACES_RANKED ? wanted : PLACES_RANKED + 1; /* one more tells that there are more */
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

void search_places_free(struct search_places *p) {
    free(p->list);
    *p = (struct search_places){0};
}
