/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Common words: FTS5 intersects the rows of a word that stands nearly everywhere with those of other words in
 * 3 to 20 ms, bit sets do it in a tenth of a millisecond. The scanning thread makes a set for each stem that
 * is in many rows, when the index has changed; searches use them while they are those of the index they read.
 */
#include "server/base/mem.h"
#include "server/library/library_internal.h"
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum {
    ROWS_LEAST = 20000, /* of an index that needs this */
    SHARE = 64,         /* a common stem is in one of so many rows */
    SAMPLED = 2000,     /* rows that are read to find the common stems */
    BYTES_MOST = 64 << 20,
};

struct common_stem {
    char stem[WORD_BYTES_MAX];
    size_t seen; /* sampled rows */
    uint64_t *rows;
};

struct common_rows {
    atomic_uint users;
    int64_t changes, last;    /* of the index; its last row */
    struct common_stem *list; /* by stem */
    size_t count, cap;
};

static size_t words_of(int64_t last) {
    return (size_t)last / 64 + 1;
}

void common_rows_release(struct common_rows *c) {
    if (!c || atomic_fetch_sub(&c->users, 1) != 1)
        return;
    for (size_t i = 0; i < c->count; i++)
        free(c->list[i].rows);
    free(c->list);
    free(c);
}

struct common_rows *common_rows_keep(struct common_rows *c) {
    if (c)
        atomic_fetch_add(&c->users, 1);
    return c;
}

bool common_rows_are_of(const struct common_rows *c, int64_t changes) {
    return c && c->changes == changes;
}

static int by_stem(const void *a, const void *b) {
    return strcmp(((const struct common_stem *)a)->stem, ((const struct common_stem *)b)->stem);
}

static int by_frequency(const void *a, const void *b) {
    const struct common_stem *x = a, *y = b;
    return x->seen != y->seen ? (x->seen < y->seen) - (x->seen > y->seen) : strcmp(x->stem, y->stem);
}

/* Collects the distinct stems of a row. */
static void sample_row(struct common_rows *c, struct stems *stems, const char *lang, const char *text,
                       size_t size) {
    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    struct word word;
    bool turkish = !strncmp(lang, "tr", 2);
    size_t from = c->count;
    for (size_t at = 0; words_next(text, size, turkish, &at, &word);)
        for (size_t i = 0, count = stems_forms(stems, lang, &word, forms); i < count; i++) {
            c->list = mem_grow(c->list, &c->cap, c->count + 1, sizeof *c->list);
            c->list[c->count] = (struct common_stem){.seen = 1};
            memcpy(c->list[c->count++].stem, forms[i], WORD_BYTES_MAX);
        }
    if (c->count == from)
        return;
    qsort(c->list + from, c->count - from, sizeof *c->list, by_stem);
    size_t to = from + 1;
    for (size_t i = from + 1; i < c->count; i++)
        if (strcmp(c->list[i].stem, c->list[to - 1].stem) != 0)
            c->list[to++] = c->list[i];
    c->count = to;
}

/* Finds stems that are in many of the sampled rows. */
static bool sample(struct common_rows *c, sqlite3 *sql, struct stems *stems) {
    sqlite3_stmt *s = NULL;
    int64_t step = c->last / SAMPLED;
    size_t sampled = 0, to = 0;
    if (sqlite3_prepare_v2(sql,
                           "SELECT lang, text FROM passage WHERE id >= ? AND name <> '' ORDER BY id LIMIT 1",
                           -1, &s, NULL) != SQLITE_OK)
        return false;
    for (int64_t row = 1; row <= c->last; row += step) {
        sqlite3_bind_int64(s, 1, row);
        if (sqlite3_step(s) == SQLITE_ROW) {
            sample_row(c, stems, index_text(s, 0), index_text(s, 1), (size_t)sqlite3_column_bytes(s, 1));
            sampled++;
        }
        sqlite3_reset(s);
    }
    sqlite3_finalize(s);
    if (c->count)
        qsort(c->list, c->count, sizeof *c->list, by_stem);
    for (size_t i = 0; i < c->count;) {
        size_t end = i + 1;
        while (end < c->count && !strcmp(c->list[end].stem, c->list[i].stem))
            end++;
        struct common_stem one = c->list[i];
        one.seen = end - i;
        if (one.seen * SHARE > sampled)
            c->list[to++] = one;
        i = end;
    }
    c->count = to;
    if (to)
        qsort(c->list, to, sizeof *c->list, by_frequency);
    size_t most = BYTES_MOST / (words_of(c->last) * sizeof(uint64_t));
    c->count = to < most ? to : most;
    if (c->count)
        qsort(c->list, c->count, sizeof *c->list, by_stem);
    return true;
}

/* Bits being set. */
struct marking {
    uint64_t *rows;
    int64_t last;
};

#define MARKING "search marking"

/* The SQL function is_marked(MARKING, rowid): sets the row's bit inside of SQLite, as is_listed does. */
static void is_marked(sqlite3_context *out, int count, sqlite3_value **values) {
    struct marking *m = sqlite3_value_pointer(values[0], MARKING);
    int64_t row = sqlite3_value_int64(values[1]);
    (void)count;
    if (m && row > 0 && row <= m->last)
        m->rows[row / 64] |= 1ULL << (row % 64);
    sqlite3_result_int(out, 1);
}

int common_rows_add(sqlite3 *sql) {
    return sqlite3_create_function(sql, "is_marked", 2, SQLITE_UTF8 | SQLITE_DIRECTONLY, NULL, is_marked,
                                   NULL, NULL);
}

/* Sets the bits of the rows that match. Returns false if SQLite reports an error. */
static bool set_rows(sqlite3_stmt *s, const char *match, uint64_t *rows, int64_t last) {
    struct marking marking = {rows, last};
    sqlite3_bind_text(s, 1, match, -1, SQLITE_STATIC);
    sqlite3_bind_pointer(s, 2, &marking, MARKING, NULL);
    sqlite3_step(s);
    return sqlite3_reset(s) == SQLITE_OK;
}

static const char rows_sql[] = "SELECT rowid FROM found WHERE found MATCH ?1 AND NOT is_marked(?2, rowid)";

struct common_rows *common_rows_make(struct index_writer *w, const atomic_bool *stop) {
    struct common_rows *c = mem_alloc(sizeof *c);
    sqlite3_stmt *s = NULL, *state = NULL;
    atomic_init(&c->users, 1);
    bool well = sqlite3_prepare_v2(w->sql, rows_sql, -1, &s, NULL) == SQLITE_OK &&
                sqlite3_prepare_v2(w->sql, "SELECT changes, (SELECT max(id) FROM passage) FROM made", -1,
                                   &state, NULL) == SQLITE_OK &&
                sqlite3_step(state) == SQLITE_ROW;
    if (well) {
        c->changes = sqlite3_column_int64(state, 0);
        c->last = sqlite3_column_int64(state, 1);
    }
    well = well && (c->last < ROWS_LEAST || sample(c, w->sql, w->stems));
    for (size_t i = 0; well && i < c->count && !atomic_load(stop); i++) {
        char match[WORD_BYTES_MAX + 20];
        snprintf(match, sizeof match, "stem : \"" STEM_SIGN "%s\"", c->list[i].stem);
        c->list[i].rows = mem_alloc(words_of(c->last) * sizeof(uint64_t));
        well = set_rows(s, match, c->list[i].rows, c->last);
    }
    sqlite3_finalize(s);
    sqlite3_finalize(state);
    if (well && !atomic_load(stop))
        return c;
    common_rows_release(c);
    return NULL;
}

static const struct common_stem *find_stem(const struct common_rows *c, const char *stem) {
    struct common_stem sought;
    snprintf(sought.stem, sizeof sought.stem, "%s", stem);
    return c->count ? bsearch(&sought, c->list, c->count, sizeof sought, by_stem) : NULL;
}

static bool is_common(const struct common_rows *c, const struct query_term *t) {
    for (size_t i = 0; i < t->stem_count; i++)
        if (find_stem(c, t->stems[i]))
            return true;
    return false;
}

/* Sets the bits of the rows that have a form of the term. Returns false if SQLite reports an error. */
static bool rows_of_term(const struct common_rows *c, sqlite3_stmt *s, const struct query_term *t,
                         uint64_t *rows) {
    struct buf rare = {0};
    bool well = true;
    size_t size = words_of(c->last);
    for (size_t i = 0; i < t->stem_count; i++) {
        const struct common_stem *known = find_stem(c, t->stems[i]);
        for (size_t k = 0; known && k < size; k++)
            rows[k] |= known->rows[k];
        if (!known)
            buf_printf(&rare, "%sstem : \"" STEM_SIGN "%s\"", rare.size ? " OR " : "", t->stems[i]);
    }
    if (rare.size) {
        buf_add(&rare, "", 1);
        well = set_rows(s, (char *)rare.data, rows, c->last);
    }
    buf_free(&rare);
    return well;
}

uint64_t *common_rows_find(const struct common_rows *c, struct index_reader *r, const struct search_query *q,
                           size_t *count) {
    sqlite3_stmt *s = NULL;
    uint64_t *all = NULL;
    bool any = false;
    for (size_t i = 0; q->bare && i < q->count; i++)
        any = any || is_common(c, &q->terms[i]);
    bool well = any && sqlite3_prepare_v2(r->sql, rows_sql, -1, &s, NULL) == SQLITE_OK;
    *count = words_of(c->last);
    for (size_t i = 0; well && i < q->count; i++) {
        uint64_t *rows = mem_alloc(*count * sizeof *rows);
        well = rows_of_term(c, s, &q->terms[i], rows);
        for (size_t k = 0; all && well && k < *count; k++)
            all[k] &= rows[k];
        if (all)
            free(rows);
        else
            all = rows;
    }
    sqlite3_finalize(s);
    if (well)
        return all;
    free(all);
    return NULL;
}
