/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Works of a library with their casts, search queries, files of casts, and speakers of a text. Byte 0 selects
 * the reader or one of the others; the rest is the text of the file or query. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/cast.h"
#include "server/library/library_internal.h"
#include "server/library/works/readers.h"
#include "server/markup/markup.h"
#include "server/markup/speaker_runs.h"
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

struct reading {
    unsigned number;
    struct cast_tally tally;
};

static int on_section(void *ctx, const struct section *section) {
    struct reading *r = ctx;
    FUZZ_CHECK(section->number == r->number + 1 && section->count);
    r->number = section->number;
    cast_tally_section(&r->tally, section);
    for (size_t i = 0; i < section->count; i++)
        check_block(&section->blocks[i]);
    return 0;
}

static void on_problem(void *ctx, const struct error *e, bool serious) {
    (void)ctx;
    (void)serious;
    FUZZ_CHECK(e->code && *e->message);
}

/* Everybody has a voice and a head, and what they speak is valid in a request. */
static void check_cast(struct cast *cast) {
    static const struct cast_voice voices[] = {
        {"a:x", "it", "female", "neural"}, {"a:y", "it-IT", "male", "formant"}, {"b:z", "en", "male", ""}};
    static const struct cast_head heads[] = {{"x", "female", ""}, {"y", "male", "child"}};
    const struct cast_offer offer = {voices, 3, heads, 2};
    struct speaker_runs runs;
    struct error e;
    cast_choose(cast, "it", &offer);
    for (size_t i = 0; i < cast->count; i++) {
        const struct cast_member *m = &cast->members[i];
        FUZZ_CHECK(m->voice && m->head && m->pitch >= 0.25 && m->pitch <= 4.8 && m->rate >= 0.25);
        const struct cast_speech speech = {0, 3, m->id, NULL};
        char *speakers = cast_speakers(cast, &speech, 1, true);
        FUZZ_CHECK(speakers && !speaker_runs_read(&runs, speakers, "abc", 3, &e));
        FUZZ_CHECK(!strcmp(speaker_runs_at(&runs, 2, NULL)->id, m->id));
        speaker_runs_free(&runs);
        free(speakers);
    }
    json_t *shown = cast_json(cast);
    FUZZ_CHECK(shown);
    json_decref(shown);
}

static void read_cast(const char *text) {
    struct cast cast = {0};
    struct error e = {0};
    cast_add(&cast, "anna", "Anna");
    cast_add(&cast, "ugo", "Ugo");
    if (cast_read(&cast, text, strlen(text), &e))
        FUZZ_CHECK(e.code == ERROR_BAD_CAST && *e.message);
    else
        check_cast(&cast);
    cast_free(&cast);
}

/* Speakers of a text: runs ascend, and each sentence has one. */
static void read_speakers(const char *text) {
    static const char said[] =
        "Chi è? Sono io, disse. \n\nE poi\tpiù nulla; nessuno \360\237\230\200 rispose. Mah.";
    struct speaker_runs runs;
    struct error e = {0};
    if (speaker_runs_read(&runs, text, said, sizeof said - 1, &e)) {
        FUZZ_CHECK(e.code == ERROR_BAD_FIELD && *e.message);
        return;
    }
    for (size_t i = 0; i < runs.count; i++)
        FUZZ_CHECK(runs.list[i].from < runs.list[i].to && runs.list[i].to < sizeof said &&
                   (!i || runs.list[i].from >= runs.list[i - 1].to));
    const struct markup_rules rules = {.lang = "it", .speakers = &runs};
    struct score *score = markup_read(markup_by_name("plain"), said, sizeof said - 1, &rules, &e);
    FUZZ_CHECK(score);
    for (size_t i = 0; i < score->sentence_count; i++) {
        const struct score_sentence *s = &score->sentences[i];
        FUZZ_CHECK(speaker_runs_at(&runs, s->start, NULL) == speaker_runs_at(&runs, s->end - 1, NULL));
    }
    score_free(score);
    speaker_runs_free(&runs);
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
        stems = stems_open(NULL);
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
    size_t kind = fuzz_below(&in, 8);
    char *text = mem_strndup((const char *)in.at, fuzz_left(&in));
    size_t length = strlen(text);
    struct work_meta meta = {.lang = mem_strdup("it")};
    struct builder b;
    struct error e = {0};
    struct reading reading = {0};
    struct cast cast = {0};
    int result = 0;
    const struct work_sink sink = {&reading, on_section, on_problem};
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
    else if (kind == 6)
        read_cast(text);
    else if (kind == 7)
        read_speakers(text);
    else if (well)
        search(text);
    FUZZ_CHECK(!result || (e.code && *e.message));
    builder_close(&b);
    cast_tally_take(&reading.tally, &meta, &cast);
    check_cast(&cast);
    cast_free(&cast);
    work_meta_free(&meta);
    free(text);
    return 0;
}
