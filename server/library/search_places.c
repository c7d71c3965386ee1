/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the rows that match a query, counts them by work, and ranks them, in bounded time. */
#include "server/base/lang.h"
#include "server/base/mem.h"
#include "server/library/library_internal.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Rows ranked against each other. If more match, stretches of equal length are ranked, spread evenly over the
 * whole library: ranking costs 2.3 µs a row, counting a tenth of that. */
enum { PLACES_RANKED = 1000, STRETCHES = 20 };

/* Rows counted; rows whose language or kind must be looked up for each. */
enum { ROWS_COUNTED = 50000, ROWS_LOOKED_UP = 20000 };

/* The best rows are read again: a row with the query's words exactly as written scores up to twice as much
 * as one with other forms. */
enum { PLACES_READ = 40 };

const char *const search_kinds[] = {"head", "paragraph", "line", "note", "speaker", "stage", ""};

static bool century_in(const char *list, int century) {
    for (const char *at = list; at && *at; at += strcspn(at, ","), at += *at == ',')
        if (strtol(at, NULL, 10) == century && century)
            return true;
    return !list;
}

static bool is_chosen(const struct library_question *q, const struct shelf_work *w) {
    return search_list_has(q->work, w->name, false) &&
           (!q->author || !strcmp(q->author, w->author) || search_list_has(q->author, w->author, false)) &&
           search_list_has(q->form, w->form, false) && century_in(q->century, w->century) &&
           (w->mixed || search_list_has(q->lang, w->lang, true));
}

int shelf_read(struct shelf *shelf, struct index_reader *r, const struct library_question *q,
               struct error *e) {
    sqlite3_stmt *s = library_prepare(
        r, "SELECT name, title, author, lang, form, century, mixed, first, last FROM work ORDER BY first", e);
    while (s && sqlite3_step(s) == SQLITE_ROW) {
        shelf->works = mem_grow(shelf->works, &shelf->cap, shelf->count + 1, sizeof *shelf->works);
        struct shelf_work *w = &shelf->works[shelf->count++];
        *w = (struct shelf_work){.name = mem_strdup(index_text(s, 0)),
                                 .title = mem_strdup(index_text(s, 1)),
                                 .author = mem_strdup(index_text(s, 2)),
                                 .lang = mem_strdup(index_text(s, 3)),
                                 .form = mem_strdup(index_text(s, 4)),
                                 .century = sqlite3_column_int(s, 5),
                                 .mixed = sqlite3_column_int(s, 6),
                                 .first = sqlite3_column_int64(s, 7),
                                 .last = sqlite3_column_int64(s, 8)};
        w->chosen = is_chosen(q, w);
    }
    sqlite3_finalize(s);
    return s ? 0 : -1;
}

void shelf_free(struct shelf *shelf) {
    for (size_t i = 0; i < shelf->count; i++) {
        struct shelf_work *w = &shelf->works[i];
        free(w->name);
        free(w->title);
        free(w->author);
        free(w->lang);
        free(w->form);
    }
    free(shelf->works);
    *shelf = (struct shelf){0};
}

/* Returns the last row of the chosen works that follow `*at` without a gap, and moves *at past them; *first
 * is the first row. Returns -1 if no more are chosen. */
static int64_t next_range(const struct shelf *shelf, size_t *at, int64_t *first) {
    while (*at < shelf->count && !shelf->works[*at].chosen)
        (*at)++;
    if (*at == shelf->count)
        return -1;
    *first = shelf->works[*at].first;
    while (*at + 1 < shelf->count && shelf->works[*at + 1].chosen)
        (*at)++;
    return shelf->works[(*at)++].last;
}

/* The kinds of passages by their names in a question. */
static bool kind_in(const char *list, int kind) {
    static const char *const names[] = {"head", "paragraph", "verse", "note", "speaker", "stage", ""};
    return search_list_has(list, names[kind], false);
}

/* True if the row is of the wanted language and kind. */
static bool row_fits(sqlite3_stmt *look, int64_t row, const struct library_question *q) {
    sqlite3_reset(look);
    sqlite3_bind_int64(look, 1, row);
    return sqlite3_step(look) == SQLITE_ROW && search_list_has(q->lang, index_text(look, 0), true) &&
           kind_in(q->kinds, sqlite3_column_int(look, 1));
}

static bool is_looked_up(const struct library_question *q, const struct shelf_work *w) {
    return q->kinds || (q->lang && w->mixed);
}

static int by_row(const void *a, const void *b) {
    const struct search_place *x = a, *y = b;
    return (x->row > y->row) - (x->row < y->row);
}

/* Returns the index of the work that has the row, which is not before `from`. */
static size_t work_of(const struct shelf *shelf, size_t from, int64_t row) {
    while (from + 1 < shelf->count && shelf->works[from].last < row)
        from++;
    return from;
}

/* Rows being listed. */
struct listing {
    struct search_places *places;
    struct shelf *shelf;
    const struct library_question *question;
    sqlite3_stmt *look;
    size_t looked, work;
};

#define LISTING "search listing"

/* Lists a matching row. Returns false if there are too many. */
static bool list_row(struct listing *l, int64_t row) {
    struct search_places *p = l->places;
    l->work = work_of(l->shelf, l->work, row);
    bool look_up = is_looked_up(l->question, &l->shelf->works[l->work]);
    if (p->count == ROWS_COUNTED || (look_up && ++l->looked > ROWS_LOOKED_UP)) {
        p->counted = false;
        return false;
    }
    if (look_up && !row_fits(l->look, row, l->question))
        return true;
    p->list = mem_grow(p->list, &p->cap, p->count + 1, sizeof *p->list);
    p->list[p->count++] = (struct search_place){.row = row, .work = (unsigned)l->work};
    l->shelf->works[l->work].places++;
    return true;
}

/* The SQL function is_listed(LISTING, rowid): lists rows inside of SQLite, whose scan is four times as fast
 * as one that returns each row. */
static void is_listed(sqlite3_context *out, int count, sqlite3_value **values) {
    struct listing *l = sqlite3_value_pointer(values[0], LISTING);
    (void)count;
    sqlite3_result_int(out, l && list_row(l, sqlite3_value_int64(values[1])));
}

int search_listing_add(sqlite3 *sql) {
    return sqlite3_create_function(sql, "is_listed", 2, SQLITE_UTF8 | SQLITE_DIRECTONLY, NULL, is_listed,
                                   NULL, NULL);
}

/* Searches the index for the rows. */
static int list_found(struct listing *l, struct index_reader *r, const struct search_query *query,
                      struct error *e) {
    sqlite3_stmt *rows = library_prepare(r,
                                         "SELECT rowid FROM found WHERE found MATCH ?1 AND rowid BETWEEN ?2 "
                                         "AND ?3 AND NOT is_listed(?4, rowid) ORDER BY rowid",
                                         e);
    int status = SQLITE_OK, result = 0;
    size_t range = 0;
    int64_t first = 0, last;
    if (!rows)
        return -1;
    sqlite3_bind_text(rows, 1, (char *)query->match.data, -1, SQLITE_STATIC);
    sqlite3_bind_pointer(rows, 4, l, LISTING, NULL);
    while (status == SQLITE_OK && l->places->counted && (last = next_range(l->shelf, &range, &first)) >= 0) {
        sqlite3_bind_int64(rows, 2, first);
        sqlite3_bind_int64(rows, 3, last);
        sqlite3_step(rows);
        status = sqlite3_reset(rows);
    }
    if (status != SQLITE_OK && status != SQLITE_INTERRUPT)
        result = error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(r->sql));
    sqlite3_finalize(rows);
    return result;
}

/* Lists the rows of a set, of which there are `count` * 64. */
static void list_set(struct listing *l, const uint64_t *set, size_t count) {
    size_t range = 0;
    int64_t first = 0, last;
    while (l->places->counted && (last = next_range(l->shelf, &range, &first)) >= 0)
        for (size_t i = (size_t)first / 64; l->places->counted && i < count && (int64_t)i <= last / 64; i++)
            for (uint64_t bits = set[i]; bits && l->places->counted; bits &= bits - 1) {
                int64_t row = (int64_t)i * 64 + __builtin_ctzll(bits);
                if (row >= first && row <= last)
                    list_row(l, row);
            }
}

/* Lists and counts the matching rows in the library's order. */
static int find_rows(struct search_places *p, struct shelf *shelf, struct index_reader *r,
                     const struct search_query *query, const struct library_question *q, struct error *e) {
    struct listing listing = {.places = p, .shelf = shelf, .question = q};
    size_t count = 0;
    /* on its row, it keeps the index as it is until the rows are found */
    sqlite3_stmt *state = library_prepare(r, "SELECT changes FROM made", e);
    listing.look = state ? library_prepare(r, "SELECT lang, kind FROM passage WHERE id = ?", e) : NULL;
    bool known = listing.look && sqlite3_step(state) == SQLITE_ROW &&
                 common_rows_are_of(r->common, sqlite3_column_int64(state, 0));
    uint64_t *set = known ? common_rows_find(r->common, r, query, &count) : NULL;
    int result = listing.look ? 0 : -1;
    p->counted = true;
    if (set)
        list_set(&listing, set, count);
    else if (!result)
        result = list_found(&listing, r, query, e);
    free(set);
    sqlite3_finalize(state);
    sqlite3_finalize(listing.look);
    return result;
}

/* Ranks the places [from, to), which are in the library's order. */
static void rank(struct search_places *p, size_t from, size_t to, sqlite3_stmt *rows,
                 const struct search_query *query) {
    sqlite3_bind_text(rows, 1, (char *)query->match.data, -1, SQLITE_STATIC);
    sqlite3_bind_int64(rows, 2, p->list[from].row);
    sqlite3_bind_int64(rows, 3, p->list[to - 1].row);
    for (size_t i = from; i < to && sqlite3_step(rows) == SQLITE_ROW;) {
        int64_t row = sqlite3_column_int64(rows, 0);
        while (i < to && p->list[i].row < row)
            i++;
        if (i < to && p->list[i].row == row) {
            p->list[i].worth = sqlite3_column_double(rows, 1);
            p->list[i++].ranked = true;
        }
    }
    sqlite3_reset(rows);
}

/* Ranks stretches at equal distances in the whole library, for a search that stopped counting, and adds the
 * rows that are not listed yet. */
static void rank_sample(struct search_places *p, const struct shelf *shelf, struct index_reader *r,
                        const struct search_query *query, const struct library_question *q) {
    struct error e;
    sqlite3_stmt *look = library_prepare(r, "SELECT lang, kind FROM passage WHERE id = ?", &e);
    sqlite3_stmt *rows =
        library_prepare(r,
                        "SELECT rowid, worth(found, ?1) FROM found WHERE found MATCH ?1 AND rowid >= ?2 "
                        "ORDER BY rowid LIMIT ?3",
                        &e);
    int64_t first = shelf->works[0].first, last = shelf->works[shelf->count - 1].last, done = first - 1;
    size_t listed = p->count, work = 0;
    for (int64_t i = 0; look && rows && i < STRETCHES; i++) {
        int64_t from = first + (last - first) / STRETCHES * i;
        sqlite3_bind_text(rows, 1, (char *)query->match.data, -1, SQLITE_STATIC);
        sqlite3_bind_int64(rows, 2, from > done ? from : done + 1);
        sqlite3_bind_int(rows, 3, PLACES_RANKED / STRETCHES);
        while (sqlite3_step(rows) == SQLITE_ROW) {
            struct search_place place = {.row = sqlite3_column_int64(rows, 0)};
            done = place.row;
            work = work_of(shelf, work, place.row);
            struct search_place *known = bsearch(&place, p->list, listed, sizeof place, by_row);
            if (!known && (!shelf->works[work].chosen ||
                           (is_looked_up(q, &shelf->works[work]) && !row_fits(look, place.row, q))))
                continue;
            if (!known) {
                p->list = mem_grow(p->list, &p->cap, p->count + 1, sizeof *p->list);
                known = &p->list[p->count++];
                *known = (struct search_place){.row = place.row, .work = (unsigned)work};
            }
            known->worth = sqlite3_column_double(rows, 1);
            known->ranked = true;
        }
        sqlite3_reset(rows);
    }
    sqlite3_finalize(rows);
    sqlite3_finalize(look);
}

static int by_worth(const void *a, const void *b) {
    const struct search_place *x = a, *y = b;
    if (x->preferred != y->preferred)
        return x->preferred ? -1 : 1;
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
    size_t most = p->ranked < PLACES_READ ? p->ranked : PLACES_READ;
    for (size_t i = 0; text && i < most; i++)
        p->list[i].worth *= 1 + (double)count_written(text, p->list[i].row, query) / (double)terms;
    if (text && most)
        qsort(p->list, most, sizeof *p->list, by_worth);
    sqlite3_finalize(text);
}

/* Moves the ranked places to the front; all keep their order. */
static void ranked_first(struct search_places *p) {
    struct search_place *sorted = mem_alloc(p->count * sizeof *sorted);
    for (size_t i = 0; i < p->count; i++)
        p->ranked += p->list[i].ranked;
    for (size_t i = 0, front = 0, back = p->ranked; i < p->count; i++)
        sorted[p->list[i].ranked ? front++ : back++] = p->list[i];
    free(p->list);
    p->list = sorted;
}

int search_places_find(struct search_places *p, struct shelf *shelf, struct index_reader *r,
                       const struct search_query *query, const struct library_question *q, struct error *e) {
    int result = shelf_read(shelf, r, q, e) || find_rows(p, shelf, r, query, q, e) ? -1 : 0;
    p->total = p->count;
    return result;
}

int search_places_rank(struct search_places *p, const struct shelf *shelf, struct index_reader *r,
                       const struct search_query *query, const struct library_question *q, struct error *e) {
    if (!p->count)
        return 0;
    sqlite3_stmt *rows = library_prepare(r,
                                         "SELECT rowid, worth(found, ?1) FROM found WHERE found MATCH ?1 AND "
                                         "rowid BETWEEN ?2 AND ?3 ORDER BY rowid",
                                         e);
    if (!rows)
        return -1;
    if (p->count <= PLACES_RANKED)
        rank(p, 0, p->count, rows, query);
    for (size_t i = 0; p->counted && p->count > PLACES_RANKED && i < STRETCHES; i++) {
        size_t from = i * p->count / STRETCHES;
        rank(p, from, from + PLACES_RANKED / STRETCHES, rows, query);
    }
    if (!p->counted && p->count > PLACES_RANKED)
        rank_sample(p, shelf, r, query, q);
    sqlite3_finalize(rows);
    ranked_first(p);
    for (size_t i = 0; q->prefer && i < p->ranked; i++)
        if (search_list_has(q->prefer, shelf->works[p->list[i].work].lang, true))
            p->list[i].preferred = true;
    qsort(p->list, p->ranked, sizeof *p->list, by_worth);
    prefer_written(p, r, query);
    return 0;
}

void search_places_free(struct search_places *p) {
    free(p->list);
    *p = (struct search_places){0};
}

/* ---- facets: how many places have each value ---- */

enum { FACET_VALUES = 50 };

static int by_count(const void *a, const void *b) {
    const json_t *x = *(json_t *const *)a, *y = *(json_t *const *)b;
    json_int_t m = json_integer_value(json_object_get(x, "count")),
               n = json_integer_value(json_object_get(y, "count"));
    return m != n ? (m < n) - (m > n)
                  : strcmp(json_string_value(json_object_get(x, "order")),
                           json_string_value(json_object_get(y, "order")));
}

/* Adds `count` to the value called `key`. */
static void tally(json_t *facet, const char *key, json_t *value, size_t count) {
    json_t *known = json_object_get(facet, key);
    if (!known) {
        known = json_pack("{ss sI sO}", "order", key, "count", (json_int_t)0, "value", value);
        json_object_set_new(facet, key, known);
    }
    json_integer_set(json_object_get(known, "count"),
                     json_integer_value(json_object_get(known, "count")) + (json_int_t)count);
    json_decref(value);
}

/* Returns the values of a facet, most frequent first, and releases it. */
static json_t *facet_list(json_t *facet) {
    size_t count = json_object_size(facet), at = 0;
    json_t **all = mem_alloc((count + 1) * sizeof(json_t *)), *list = json_array(), *value;
    const char *key;
    json_object_foreach(facet, key, value) all[at++] = value;
    qsort(all, count, sizeof(json_t *), by_count);
    for (size_t i = 0; i < count && i < FACET_VALUES; i++) {
        json_object_del(all[i], "order");
        json_array_append(list, all[i]);
    }
    free(all);
    json_decref(facet);
    return list;
}

json_t *search_facets(const struct shelf *shelf) {
    json_t *authors = json_object(), *langs = json_object(), *forms = json_object(),
           *centuries = json_object(), *works = json_object();
    for (size_t i = 0; i < shelf->count; i++) {
        const struct shelf_work *w = &shelf->works[i];
        char century[16];
        if (!w->places)
            continue;
        snprintf(century, sizeof century, "%d", w->century);
        if (*w->author)
            tally(authors, w->author, json_string(w->author), w->places);
        tally(langs, w->lang, json_string(w->lang), w->places);
        tally(forms, w->form, json_string(w->form), w->places);
        if (w->century)
            tally(centuries, century, json_integer(w->century), w->places);
        tally(works, w->name,
              json_pack("{ss ss ss*}", "id", w->name, "title", w->title, "author",
                        *w->author ? w->author : NULL),
              w->places);
    }
    return json_pack("{so so so so so}", "author", facet_list(authors), "lang", facet_list(langs), "form",
                     facet_list(forms), "century", facet_list(centuries), "work", facet_list(works));
}

enum { TITLES_MOST = 20 };

json_t *search_titles(const struct shelf *shelf, const struct search_query *query, struct stems *stems) {
    json_t *list = json_array();
    for (size_t i = 0; i < shelf->count && json_array_size(list) < TITLES_MOST; i++) {
        const struct shelf_work *w = &shelf->works[i];
        if (!w->chosen)
            continue;
        struct buf both = {0};
        buf_printf(&both, "%s\n%s", w->title, w->author);
        buf_add(&both, "", 1);
        if (search_query_has_all(query, stems, w->lang, (char *)both.data))
            json_array_append_new(list, json_pack("{ss ss ss* ss}", "id", w->name, "title", w->title,
                                                  "author", *w->author ? w->author : NULL, "lang", w->lang));
        buf_free(&both);
    }
    return list;
}
