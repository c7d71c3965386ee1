/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of common words: the same as those that the full-text index finds. */
#include "server/base/mem.h"
#include "server/library/library_internal.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { ROWS = 21000 };

static char file[] = "/tmp/faccia-common-XXXXXX";

/* Adds rows of words that are in every row, in each 2nd, 3rd, 5th, and in few. */
static void add_rows(struct index_writer *w, const char *work) {
    struct error e;
    struct section section = {.number = 1, .title = "Prova", .passages = ROWS};
    section.blocks = mem_alloc(ROWS * sizeof *section.blocks);
    section.count = ROWS;
    for (size_t i = 0; i < ROWS; i++) {
        struct block *b = &section.blocks[i];
        b->kind = BLOCK_PARAGRAPH;
        snprintf(b->name, sizeof b->name, "p%zu", i + 1);
        buf_printf(&b->text, "pane%s%s%s%s", i % 2 ? "" : " vini", i % 3 ? "" : " belle",
                   i % 5 ? "" : " sale", i % 499 ? "" : " zafferano");
    }
    assert_int_equal(index_begin(w, &e), 0);
    int64_t first = w->next;
    assert_int_equal(index_add_section(w, work, "it", &section, &e), 0);
    const struct work_meta meta = {.title = "Prova", .lang = "it"};
    assert_int_equal(index_add_work(w, work, work, "", &meta, first, false, &e), 0);
    assert_int_equal(index_commit(w, &e), 0);
    for (size_t i = 0; i < ROWS; i++)
        buf_free(&section.blocks[i].text);
    free(section.blocks);
}

/* Counts the rows of a query by the set, or returns -1 if it must be searched; all of them match. */
static long count_by_set(const struct common_rows *rows, struct index_reader *r, const char *text) {
    struct query_options options = {r->stems, "it", NULL};
    struct search_query query;
    struct error e;
    size_t size, count = 0, bits = 0;
    assert_int_equal(search_query_read(&query, text, &options, &e), 0);
    uint64_t *set = common_rows_find(rows, r, &query, &size);
    for (size_t i = 0; set && i < size; i++)
        bits += (size_t)__builtin_popcountll(set[i]);
    sqlite3_stmt *s = library_prepare(r, "SELECT rowid FROM found WHERE found MATCH ?", &e);
    sqlite3_bind_text(s, 1, (char *)query.match.data, -1, SQLITE_STATIC);
    while (sqlite3_step(s) == SQLITE_ROW) {
        int64_t row = sqlite3_column_int64(s, 0);
        assert_true(!set || set[row / 64] >> (row % 64) & 1);
        count++;
    }
    sqlite3_finalize(s);
    search_query_free(&query);
    assert_true(!set || bits == count);
    long result = set ? (long)bits : -1;
    free(set);
    return result;
}

static void finds_the_rows_of_common_words(void **state) {
    (void)state;
    struct index_writer w;
    struct error e;
    const struct index_rules rules = {0};
    atomic_bool stop = false;
    int descriptor = mkstemp(file);
    assert_true(descriptor >= 0);
    close(descriptor);
    assert_int_equal(index_open(&w, file, &rules, &e), 0);
    add_rows(&w, "uno");
    struct common_rows *rows = common_rows_make(&w, &stop);
    assert_non_null(rows);
    assert_true(common_rows_are_of(rows, index_changes(&w)));
    struct index_reader r = {.sql = index_open_reader(file), .stems = stems_open(NULL)};
    assert_non_null(r.sql);
    assert_int_equal(count_by_set(rows, &r, "pane"), ROWS);
    assert_int_equal(count_by_set(rows, &r, "vino pane"), ROWS / 2);
    assert_int_equal(count_by_set(rows, &r, "bello vino sale"), ROWS / 30);
    assert_int_equal(count_by_set(rows, &r, "zafferano"), -1);
    assert_int_equal(count_by_set(rows, &r, "pane zafferano"), (ROWS - 1) / 499 + 1);
    assert_int_equal(count_by_set(rows, &r, "sale zafferano vino"), (ROWS - 1) / 4990 + 1);
    assert_int_equal(count_by_set(rows, &r, "pane pepe"), 0);
    for (size_t i = 0; i < 6; i++) {
        static const char *const others[] = {"\"pane\" vino", "pan* vino",     "pane NOT vino",
                                             "pane OR vino",  "(pane) (vino)", "NEAR(pane vini)"};
        assert_int_equal(count_by_set(rows, &r, others[i]), -1);
    }

    struct common_rows *kept = common_rows_keep(rows);
    common_rows_release(rows);
    add_rows(&w, "due");
    assert_false(common_rows_are_of(kept, index_changes(&w)));
    common_rows_release(kept);
    index_merge(&w, &stop);
    rows = common_rows_make(&w, &stop);
    assert_int_equal(count_by_set(rows, &r, "vino pane"), ROWS);
    common_rows_release(rows);

    stop = true;
    assert_null(common_rows_make(&w, &stop));
    sqlite3_close(r.sql);
    stems_close(r.stems);
    index_close(&w);
    static const char *const ends[] = {"", "-wal", "-shm"};
    for (size_t i = 0; i < 3; i++) {
        char path[64];
        snprintf(path, sizeof path, "%s%s", file, ends[i]);
        unlink(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(finds_the_rows_of_common_words)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
