/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works of a library, and search queries. Byte 0 selects the reader, or a query; the rest is the text of the
 * file or query. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/library_internal.h"
#include "server/library/readers.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

static void check_block(const struct block *b) {
    size_t end = 0;
    for (size_t i = 0; i < b->mark_count; i++)
        FUZZ_CHECK(b->marks[i].start <= b->marks[i].end && b->marks[i].end <= b->text.size);
    for (size_t i = 0; i < b->line_count; i++) {
        FUZZ_CHECK(b->lines[i].start >= end && b->lines[i].end >= b->lines[i].start);
        end = b->lines[i].end;
    }
    FUZZ_CHECK(end <= b->text.size);
    FUZZ_CHECK(!b->text.size || utf8_check((char *)b->text.data, b->text.size) == b->text.size);
    char *shape = index_shape(b);
    FUZZ_CHECK(shape);
    free(shape);
}

static int on_section(void *ctx, const struct section *section) {
    unsigned *number = ctx;
    FUZZ_CHECK(section->number == *number + 1 && section->count);
    *number = section->number;
    for (size_t i = 0; i < section->count; i++)
        check_block(&section->blocks[i]);
    return 0;
}

static void on_problem(void *ctx, const struct error *e, bool serious) {
    (void)ctx;
    (void)serious;
    FUZZ_CHECK(e->code && *e->message);
}

/* Every valid query is accepted by FTS5. */
static void search(const char *text) {
    static sqlite3 *sql;
    static struct stems *stems;
    struct search_query query;
    struct error e = {0};
    sqlite3_stmt *s = NULL;
    if (!sql) {
        sqlite3_open(":memory:", &sql);
        sqlite3_exec(sql, "CREATE VIRTUAL TABLE found USING fts5 (word, stem, content='')", NULL, NULL, NULL);
        stems = stems_open();
    }
    const struct query_options options = {.stems = stems};
    if (search_query_read(&query, text, &options, &e)) {
        FUZZ_CHECK(e.code == ERROR_BAD_QUERY && e.place == PLACE_BYTE && e.byte <= strlen(text));
    } else {
        sqlite3_prepare_v2(sql, "SELECT rowid FROM found WHERE found MATCH ?", -1, &s, NULL);
        sqlite3_bind_text(s, 1, (char *)query.match.data, -1, SQLITE_STATIC);
        FUZZ_CHECK(sqlite3_step(s) == SQLITE_DONE);
        sqlite3_finalize(s);
    }
    search_query_free(&query);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    size_t kind = fuzz_below(&in, 6);
    char *text = mem_strndup((const char *)in.at, fuzz_left(&in));
    size_t length = strlen(text);
    struct work_meta meta = {.lang = mem_strdup("it")};
    struct builder b;
    struct error e = {0};
    unsigned number = 0;
    int result = 0;
    const struct work_sink sink = {&number, on_section, on_problem};
    bool well = utf8_check(text, length) == length;
    builder_open(&b, &sink);
    if (kind == 0)
        result = tei_read(text, length, &meta, &b, &e);
    else if (kind == 1)
        result = xhtml_read(text, length, "a.xhtml", &b, &e);
    else if (kind == 2 && well)
        result = commonmark_read(text, length, &meta, &b, &e);
    else if (kind == 3 && well)
        result = plain_work_read(text, length, &meta, &b, &e);
    else if (kind == 4 && well)
        result = markup_work_read(text, length, "ssml", &meta, &b, &e);
    else if (well)
        search(text);
    FUZZ_CHECK(!result || (e.code && *e.message));
    builder_close(&b);
    work_meta_free(&meta);
    free(text);
    return 0;
}
