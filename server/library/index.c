/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/cast.h"
#include "server/library/directions.h"
#include "server/library/library_internal.h"
#include <jansson.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SCHEMA "8"
#define APPLICATION "1717985378" /* "fabl" */

static const char schema[] =
    "PRAGMA application_id=" APPLICATION ";"
    "PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL; PRAGMA cache_size=-32768;"
    "CREATE TABLE IF NOT EXISTS file (path TEXT PRIMARY KEY, size INTEGER, modified INTEGER, hash TEXT, work "
    "TEXT) "
    "WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS work (name TEXT PRIMARY KEY, path TEXT, hash TEXT, title TEXT, author TEXT, "
    "lang TEXT, "
    "date TEXT, publisher TEXT, licence TEXT, source TEXT, format TEXT, sections INTEGER, passages INTEGER, "
    "characters INTEGER, first INTEGER, last INTEGER, recording INTEGER, form TEXT, century INTEGER, mixed "
    "INTEGER) WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS section (work TEXT, number INTEGER, title TEXT, level INTEGER, passages "
    "INTEGER, "
    "characters INTEGER, first INTEGER, last INTEGER, PRIMARY KEY (work, number)) WITHOUT ROWID;"
    "CREATE TABLE IF NOT EXISTS passage (id INTEGER PRIMARY KEY, work TEXT, section INTEGER, name TEXT, kind "
    "INTEGER, "
    "part INTEGER, start INTEGER, first_line INTEGER, line_count INTEGER, lang TEXT, shape TEXT, text TEXT, "
    "source TEXT, "
    "markup TEXT, runs TEXT, who TEXT, affect TEXT);"
    "CREATE INDEX IF NOT EXISTS passage_name ON passage (work, section, name);"
    "CREATE INDEX IF NOT EXISTS passage_line ON passage (work, section, first_line) WHERE line_count > 0;"
    "CREATE TABLE IF NOT EXISTS problem (path TEXT, code TEXT, line INTEGER, col INTEGER, message TEXT, "
    "serious "
    "INTEGER);"
    "CREATE TABLE IF NOT EXISTS person (work TEXT, place INTEGER, id TEXT, name TEXT, about TEXT, sex "
    "INTEGER, "
    "age INTEGER, sex_from INTEGER, passages INTEGER, characters INTEGER, told INTEGER, said TEXT, PRIMARY "
    "KEY (work, "
    "place)) WITHOUT "
    "ROWID;"
    "CREATE TABLE IF NOT EXISTS made (rules INTEGER, changes INTEGER);"
    "CREATE TABLE IF NOT EXISTS former (work TEXT PRIMARY KEY, hash TEXT) WITHOUT ROWID;"
    "CREATE INDEX IF NOT EXISTS work_hash ON work (hash);"
    "CREATE INDEX IF NOT EXISTS problem_path ON problem (path);"
    "CREATE VIRTUAL TABLE IF NOT EXISTS found USING fts5 (word, stem, speaker, stage, content='', "
    "tokenize='unicode61 remove_diacritics 2');"
    "INSERT INTO found (found, rank) VALUES ('hashsize', 33554432);"
    "PRAGMA user_version=" SCHEMA ";";

static int64_t number_of(sqlite3 *sql, const char *query) {
    sqlite3_stmt *s = NULL;
    int64_t number = -1;
    if (sqlite3_prepare_v2(sql, query, -1, &s, NULL) == SQLITE_OK && sqlite3_step(s) == SQLITE_ROW)
        number = sqlite3_column_int64(s, 0);
    sqlite3_finalize(s);
    return number;
}

bool index_is_damaged(sqlite3 *sql) {
    int code = sqlite3_errcode(sql) & 0xff;
    return code == SQLITE_CORRUPT || code == SQLITE_NOTADB;
}

void index_discard(const char *file) {
    static const char *const ends[] = {"", "-wal", "-shm"};
    char path[4096];
    log_warn("the index %s is damaged or of another version; rebuilding it", file);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        snprintf(path, sizeof path, "%s%s", file, ends[i]);
        unlink(path);
    }
}

static int fail(struct index_writer *w, struct error *e) {
    sqlite3 *sql = w->sql;
    w->damaged = w->damaged || index_is_damaged(sql);
    return error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(sql));
}

/* Returns whether the index was made by these rules, and notes it in a new one. */
static bool is_of_rules(struct index_writer *w, const struct index_rules *rules) {
    char sql[120];
    int64_t hash = (int64_t)((spellings_hash(rules->spellings) ^ directions_hash(rules->directions)) >>
                             1); /* not negative, as number_of needs it */
    snprintf(sql, sizeof sql, "INSERT INTO made SELECT %lld, 0 WHERE NOT EXISTS (SELECT 1 FROM made)",
             (long long)hash);
    return sqlite3_exec(w->sql, sql, NULL, NULL, NULL) == SQLITE_OK &&
           number_of(w->sql, "SELECT rules FROM made") == hash;
}

static int try_open(struct index_writer *w, const char *file, const struct index_rules *rules) {
    if (sqlite3_open(file, &w->sql) != SQLITE_OK || common_rows_add(w->sql))
        return -1;
    sqlite3_busy_timeout(w->sql, 5000);
    int64_t version = number_of(w->sql, "PRAGMA user_version");
    int64_t application = number_of(w->sql, "PRAGMA application_id");
    if (version < 0 || application < 0)
        return -1;
    if (application && application != 1717985378)
        return 1; /* another program's database */
    if ((version && version != atoi(SCHEMA)) || sqlite3_exec(w->sql, schema, NULL, NULL, NULL) != SQLITE_OK)
        return -1;
    w->next = number_of(w->sql, "SELECT coalesce(max(id), 0) + 1 FROM passage");
    return w->next > 0 && is_of_rules(w, rules) ? 0 : -1;
}

int index_open(struct index_writer *w, const char *file, const struct index_rules *rules, struct error *e) {
    *w = (struct index_writer){0};
    int result = try_open(w, file, rules);
    if (result < 0 && w->sql && !access(file, R_OK | W_OK)) {
        sqlite3_close(w->sql);
        index_discard(file);
        result = try_open(w, file, rules);
    }
    if (result > 0)
        error_set(e, ERROR_BAD_INDEX, "%.200s belongs to another program", file);
    else if (result)
        error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", file, sqlite3_errmsg(w->sql));
    if (result) {
        sqlite3_close(w->sql);
        w->sql = NULL;
        return -1;
    }
    w->rules = rules;
    w->stems = stems_open(rules->spellings);
    return 0;
}

int64_t index_changes(struct index_writer *w) {
    return number_of(w->sql, "SELECT changes FROM made");
}

void index_close(struct index_writer *w) {
    index_roll_back(w);
    for (size_t i = 0; i < sizeof w->statements / sizeof *w->statements; i++)
        sqlite3_finalize(w->statements[i]);
    sqlite3_close(w->sql);
    stems_close(w->stems);
    *w = (struct index_writer){0};
}

/* The file is not memory-mapped: truncation or a disk error would kill the daemon with SIGBUS. */
sqlite3 *index_open_reader(const char *file) {
    sqlite3 *sql = NULL;
    if (sqlite3_open_v2(file, &sql, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, NULL) != SQLITE_OK ||
        sqlite3_exec(sql, "PRAGMA query_only=1; PRAGMA cache_size=-16384;", NULL, NULL, NULL) != SQLITE_OK ||
        search_rank_add(sql) || search_listing_add(sql) || common_rows_add(sql)) {
        sqlite3_close(sql);
        return NULL;
    }
    sqlite3_busy_timeout(sql, 1000);
    return sql;
}

/* Returns a statement that is prepared once, with its parameters cleared. */
static sqlite3_stmt *index_statement(struct index_writer *w, unsigned number, const char *sql) {
    sqlite3_stmt **s = &w->statements[number];
    if (!*s && sqlite3_prepare_v3(w->sql, sql, -1, SQLITE_PREPARE_PERSISTENT, s, NULL) != SQLITE_OK)
        log_warn("the index: %s", sqlite3_errmsg(w->sql));
    sqlite3_clear_bindings(*s);
    return *s;
}

int index_step(struct index_writer *w, sqlite3_stmt *statement, struct error *e) {
    int result = statement ? sqlite3_step(statement) : SQLITE_ERROR;
    if (result != SQLITE_ROW && result != SQLITE_DONE) {
        fail(w, e);
        sqlite3_reset(statement);
        return -1;
    }
    if (result == SQLITE_DONE)
        sqlite3_reset(statement);
    return result == SQLITE_ROW;
}

int index_begin(struct index_writer *w, struct error *e) {
    if (!w->open && sqlite3_exec(w->sql, "BEGIN", NULL, NULL, NULL) != SQLITE_OK)
        return fail(w, e);
    w->open = true;
    return 0;
}

int index_commit(struct index_writer *w, struct error *e) {
    if (!w->open)
        return 0;
    w->characters = 0;
    if (sqlite3_exec(w->sql, "UPDATE made SET changes = changes + 1; COMMIT", NULL, NULL, NULL) !=
        SQLITE_OK) {
        fail(w, e);
        index_roll_back(w);
        return -1;
    }
    w->open = false;
    return 0;
}

void index_roll_back(struct index_writer *w) {
    if (!w->open)
        return;
    sqlite3_exec(w->sql, "ROLLBACK", NULL, NULL, NULL);
    w->open = false;
    w->next = number_of(w->sql, "SELECT coalesce(max(id), 0) + 1 FROM passage");
}

void index_merge(struct index_writer *w, const atomic_bool *stop) {
    enum { PAGES = 1000 };
    char sql[80];
    for (int pages = -PAGES, before = 0; !atomic_load(stop); pages = PAGES) {
        before = sqlite3_total_changes(w->sql);
        snprintf(sql, sizeof sql, "INSERT INTO found (found, rank) VALUES ('merge', %d)", pages);
        if (sqlite3_exec(w->sql, sql, NULL, NULL, NULL) != SQLITE_OK ||
            (pages > 0 && sqlite3_total_changes(w->sql) - before < 2))
            return;
    }
}

static void add_stem(struct buf *stemmed, const char *stem) {
    buf_add(stemmed, " ", stemmed->size ? 1 : 0);
    buf_add(stemmed, STEM_SIGN, strlen(STEM_SIGN));
    buf_add(stemmed, stem, strlen(stem));
}

/* Fills the two columns of `found` for a text. A word without a stem enters the stem column itself, since
 * a search for a word's forms reads that column only. */
static void index_columns(struct stems *stems, const char *lang, const char *text, size_t size,
                          struct buf *words, struct buf *stemmed) {
    struct word word;
    char forms[STEM_FORMS_MAX][WORD_BYTES_MAX];
    bool turkish = !strncmp(lang, "tr", 2) && (!lang[2] || lang[2] == '-');
    for (size_t at = 0; words_next(text, size, turkish, &at, &word);) {
        if (!word.folded[0])
            continue;
        buf_add(words, " ", words->size ? 1 : 0);
        buf_add(words, word.folded, strlen(word.folded));
        size_t count = stems_forms(stems, lang, &word, forms);
        for (size_t i = 0; i < count; i++)
            add_stem(stemmed, forms[i]);
        if (!count)
            add_stem(stemmed, word.folded);
    }
}

/* The columns of `found` for a row: words and stems of a passage, or both in one column of their own for
 * names of speakers and stage directions, which an ordinary search does not read. */
struct columns {
    struct buf list[4]; /* word, stem, speaker, stage */
};

static bool is_found(int kind, const char *name) {
    return *name || kind == BLOCK_SPEAKER || kind == BLOCK_STAGE;
}

static void columns_fill(struct columns *c, struct stems *stems, int kind, const char *lang, const char *text,
                         size_t size) {
    *c = (struct columns){0};
    if (kind != BLOCK_SPEAKER && kind != BLOCK_STAGE) {
        index_columns(stems, lang, text, size, &c->list[0], &c->list[1]);
        return;
    }
    struct buf stemmed = {0}, *own = &c->list[kind == BLOCK_SPEAKER ? 2 : 3];
    index_columns(stems, lang, text, size, own, &stemmed);
    if (stemmed.size)
        buf_printf(own, " %.*s", (int)stemmed.size, (char *)stemmed.data);
    buf_free(&stemmed);
}

/* Binds the columns from parameter 2 on, takes the step, and releases them. */
static int columns_write(struct columns *c, struct index_writer *w, sqlite3_stmt *s, int64_t row,
                         struct error *e) {
    sqlite3_bind_int64(s, 1, row);
    for (int i = 0; i < 4; i++)
        sqlite3_bind_text(s, 2 + i, c->list[i].size ? (char *)c->list[i].data : "", (int)c->list[i].size,
                          SQLITE_STATIC);
    int result = index_step(w, s, e);
    sqlite3_clear_bindings(s);
    for (int i = 0; i < 4; i++)
        buf_free(&c->list[i]);
    return result;
}

static const char *const kinds[] = {
    [BLOCK_HEAD] = "head", [BLOCK_PARAGRAPH] = "paragraph", [BLOCK_VERSE] = "verse",
    [BLOCK_NOTE] = "note", [BLOCK_SPEAKER] = "speaker",     [BLOCK_STAGE] = "stage",
    [BLOCK_PAGE] = "page"};
static const char *const marks[] = {
    [MARK_EMPHASIS] = "emphasis", [MARK_FOREIGN] = "foreign", [MARK_NAME] = "name",
    [MARK_NOTE] = "note",         [MARK_PAGE] = "page",       [MARK_STAGE] = "stage"};
static const char *const values[] = {
    [MARK_EMPHASIS] = "value", [MARK_FOREIGN] = "lang", [MARK_NAME] = "value",
    [MARK_NOTE] = "note",      [MARK_PAGE] = "n",       [MARK_STAGE] = "value"};

/* A byte offset in a block's text and its UTF-16 offset. */
struct place {
    size_t byte, unit;
};

static int compare_places(const void *left, const void *right) {
    const struct place *a = left, *b = right;
    return a->byte < b->byte ? -1 : a->byte > b->byte;
}

/* Returns both ends of each mark, sorted by byte: nested marks are in no order that a single pass could
 * follow. Free it. */
static struct place *find_places(const struct block *b, size_t *count) {
    struct place *places = mem_alloc(2 * b->mark_count * sizeof *places);
    struct utf16_counter counter = {0};
    for (size_t i = 0; i < b->mark_count; i++) {
        places[2 * i].byte = b->marks[i].start;
        places[2 * i + 1].byte = b->marks[i].end;
    }
    *count = 2 * b->mark_count;
    qsort(places, *count, sizeof *places, compare_places);
    for (size_t i = 0; i < *count && places[i].byte <= b->text.size; i++)
        places[i].unit = utf16_offset(&counter, (const char *)b->text.data, places[i].byte);
    return places;
}

static json_int_t unit_of(const struct place *places, size_t count, size_t byte) {
    const struct place sought = {.byte = byte};
    const struct place *found = bsearch(&sought, places, count, sizeof *places, compare_places);
    return (json_int_t)found->unit;
}

static void add_marks(json_t *shape, const struct block *b) {
    json_t *list = json_array();
    size_t count;
    struct place *places = find_places(b, &count);
    for (size_t i = 0; i < b->mark_count; i++) {
        const struct block_mark *m = &b->marks[i];
        if (m->start > b->text.size || m->end > b->text.size)
            continue;
        json_array_append_new(list, json_pack("{ss sI sI ss*}", "kind", marks[m->kind], "start",
                                              unit_of(places, count, m->start), "end",
                                              unit_of(places, count, m->end), values[m->kind], m->value));
    }
    free(places);
    json_object_set_new(shape, "marks", list);
}

static void add_lines(json_t *shape, const struct block *b) {
    json_t *list = json_array();
    struct utf16_counter at = {0};
    const char *text = b->text.size ? (const char *)b->text.data : "";
    for (size_t i = 0; i < b->line_count; i++) {
        const struct block_line *l = &b->lines[i];
        char counted[16];
        snprintf(counted, sizeof counted, "%zu", b->first_line + i);
        json_t *line = json_pack("{ss sI}", "n", l->n ? l->n : counted, "start",
                                 (json_int_t)utf16_offset(&at, text, l->start));
        json_object_set_new(line, "end", json_integer((json_int_t)utf16_offset(&at, text, l->end)));
        if (l->indent)
            json_object_set_new(line, "indent", json_true());
        json_array_append_new(list, line);
    }
    json_object_set_new(shape, "lines", list);
}

char *index_shape(const struct block *b) {
    char who[CAST_ID_BYTES];
    cast_id_of_block(b, who);
    json_t *shape = json_pack("{ss ss* ss* ss* ss* ss*}", "kind", kinds[b->kind], "lang", b->lang, "speaker",
                              b->speaker, "who", *who ? who : NULL, "n", b->n, "markup", b->markup);
    if (b->kind == BLOCK_HEAD)
        json_object_set_new(shape, "level", json_integer(b->level));
    if (b->item)
        json_object_set_new(shape, "item", json_true());
    if (b->mark_count)
        add_marks(shape, b);
    if (b->kind == BLOCK_VERSE)
        add_lines(shape, b);
    char *text = json_dumps(shape, JSON_COMPACT);
    json_decref(shape);
    return text;
}

/* Indexes of prepared statements, see index_statement. */
enum {
    GET_FILE,
    SET_FILE,
    DROP_FILE,
    GET_WORK,
    GET_ROWS,
    DROP_FOUND,
    DROP_ROWS,
    DROP_SECTIONS,
    DROP_WORK,
    DROP_CAST,
    DROP_PROBLEMS,
    ADD_ROW,
    ADD_FOUND,
    ADD_SECTION,
    ADD_WORK,
    ADD_PROBLEM,
    ADD_PERSON,
    ADD_FORMER,
};

static void bind_text(sqlite3_stmt *s, int at, const char *text) {
    sqlite3_bind_text(s, at, text, -1, SQLITE_TRANSIENT);
}

const char *index_text(sqlite3_stmt *s, int column) {
    const char *text = (const char *)sqlite3_column_text(s, column);
    return text ? text : "";
}

bool index_file_get(struct index_writer *w, const char *path, struct index_file *out) {
    struct error e;
    sqlite3_stmt *s =
        index_statement(w, GET_FILE, "SELECT size, modified, hash, work FROM file WHERE path = ?");
    *out = (struct index_file){0};
    bind_text(s, 1, path);
    bool found = index_step(w, s, &e) == 1;
    if (found) {
        out->size = sqlite3_column_int64(s, 0);
        out->modified = sqlite3_column_int64(s, 1);
        snprintf(out->hash, sizeof out->hash, "%s", index_text(s, 2));
        snprintf(out->work, sizeof out->work, "%s", index_text(s, 3));
        sqlite3_reset(s);
    }
    return found;
}

int index_file_set(struct index_writer *w, const char *path, const struct index_file *file, struct error *e) {
    sqlite3_stmt *s = index_statement(w, SET_FILE, "INSERT OR REPLACE INTO file VALUES (?, ?, ?, ?, ?)");
    bind_text(s, 1, path);
    sqlite3_bind_int64(s, 2, file->size);
    sqlite3_bind_int64(s, 3, file->modified);
    bind_text(s, 4, file->hash);
    bind_text(s, 5, file->work);
    return index_step(w, s, e) < 0 ? -1 : 0;
}

/* A contentless FTS5 table needs the original words to delete a row. */
static int remove_rows(struct index_writer *w, int64_t first, int64_t last, struct error *e) {
    sqlite3_stmt *rows = index_statement(
        w, GET_ROWS, "SELECT id, lang, text, kind, name FROM passage WHERE id BETWEEN ? AND ?");
    int result;
    sqlite3_bind_int64(rows, 1, first);
    sqlite3_bind_int64(rows, 2, last);
    while ((result = index_step(w, rows, e)) == 1) {
        int kind = sqlite3_column_int(rows, 3);
        if (!is_found(kind, index_text(rows, 4)))
            continue;
        sqlite3_stmt *drop = index_statement(
            w, DROP_FOUND,
            "INSERT INTO found (found, rowid, word, stem, speaker, stage) VALUES ('delete', ?, ?, ?, ?, ?)");
        struct columns columns;
        columns_fill(&columns, w->stems, kind, index_text(rows, 1), index_text(rows, 2),
                     (size_t)sqlite3_column_bytes(rows, 2));
        if (columns_write(&columns, w, drop, sqlite3_column_int64(rows, 0), e) < 0) {
            sqlite3_reset(rows);
            return -1;
        }
    }
    if (result < 0)
        return -1;
    sqlite3_stmt *drop = index_statement(w, DROP_ROWS, "DELETE FROM passage WHERE id BETWEEN ? AND ?");
    sqlite3_bind_int64(drop, 1, first);
    sqlite3_bind_int64(drop, 2, last);
    return index_step(w, drop, e) < 0 ? -1 : 0;
}

static int drop(struct index_writer *w, unsigned number, const char *sql, const char *key, struct error *e) {
    sqlite3_stmt *s = index_statement(w, number, sql);
    bind_text(s, 1, key);
    return index_step(w, s, e) < 0 ? -1 : 0;
}

int index_remove(struct index_writer *w, const char *path, struct error *e) {
    struct index_file file;
    int64_t first = 1, last = 0;
    if (index_begin(w, e))
        return -1;
    if (index_file_get(w, path, &file) && *file.work) {
        sqlite3_stmt *s = index_statement(w, GET_WORK, "SELECT first, last FROM work WHERE name = ?");
        bind_text(s, 1, file.work);
        if (index_step(w, s, e) == 1) {
            first = sqlite3_column_int64(s, 0);
            last = sqlite3_column_int64(s, 1);
            sqlite3_reset(s);
        }
        if (remove_rows(w, first, last, e) ||
            drop(w, DROP_SECTIONS, "DELETE FROM section WHERE work = ?", file.work, e) ||
            drop(w, DROP_WORK, "DELETE FROM work WHERE name = ?", file.work, e) ||
            drop(w, DROP_CAST, "DELETE FROM person WHERE work = ?", file.work, e))
            return -1;
    }
    return drop(w, DROP_PROBLEMS, "DELETE FROM problem WHERE path = ?", path, e) ||
                   drop(w, DROP_FILE, "DELETE FROM file WHERE path = ?", path, e)
               ? -1
               : 0;
}

struct part {
    size_t from, to, first_line, lines;
};

/* Returns the part of a block's text that starts at `from`. */
static struct part next_part(const struct block *b, size_t from, size_t line) {
    struct part part = {from, b->text.size, 0, 0};
    if (b->kind == BLOCK_VERSE) {
        size_t end = line + PART_LINES < b->line_count ? line + PART_LINES : b->line_count;
        part.first_line = b->first_line + line;
        part.lines = end - line;
        part.to = end == b->line_count ? b->text.size : b->lines[end - 1].end;
    } else if (b->text.size - from > PART_BYTES) {
        part.to = from + PART_BYTES;
        while (part.to > from + PART_BYTES / 2 && b->text.data[part.to - 1] != ' ')
            part.to--;
        while (part.to < b->text.size && (b->text.data[part.to] & 0xC0) == 0x80)
            part.to++;
    }
    return part;
}

/* Lists the stretches that are in another language or not spoken: "START-END:LANG ", in UTF-16 units of
 * the part; a stage direction has an empty language. */
static void runs_of(const struct block *b, const struct part *part, struct buf *out) {
    const char *text = b->text.size ? (const char *)b->text.data + part->from : "";
    struct utf16_counter counter = {0};
    for (size_t i = 0; i < b->mark_count && b->marks[i].start < part->to; i++) {
        const struct block_mark *m = &b->marks[i];
        size_t start = m->start > part->from ? m->start : part->from,
               end = m->end < part->to ? m->end : part->to;
        bool foreign = m->kind == MARK_FOREIGN && m->value;
        if (start >= end || (!foreign && m->kind != MARK_STAGE))
            continue;
        size_t from = utf16_offset(&counter, text, start - part->from);
        buf_printf(out, "%zu-%zu:%s ", from, utf16_offset(&counter, text, end - part->from),
                   foreign ? m->value : "");
    }
}

static int add_row(struct index_writer *w, const char *work, unsigned section, const char *lang,
                   const struct block *b, const struct part *part, unsigned number, size_t start, char *shape,
                   const char *affect, struct error *e) {
    const char *text = b->text.size ? (const char *)b->text.data + part->from : "";
    size_t size = part->to - part->from;
    char who[CAST_ID_BYTES];
    struct buf runs = {0};
    runs_of(b, part, &runs);
    sqlite3_stmt *s = index_statement(
        w, ADD_ROW, "INSERT INTO passage VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    sqlite3_bind_int64(s, 1, w->next);
    sqlite3_bind_text(s, 2, work, -1, SQLITE_STATIC);
    sqlite3_bind_int(s, 3, (int)section);
    sqlite3_bind_text(s, 4, b->name, -1, SQLITE_STATIC);
    sqlite3_bind_int(s, 5, (int)b->kind);
    sqlite3_bind_int(s, 6, (int)number);
    sqlite3_bind_int64(s, 7, (int64_t)start);
    sqlite3_bind_int64(s, 8, (int64_t)part->first_line);
    sqlite3_bind_int64(s, 9, (int64_t)part->lines);
    sqlite3_bind_text(s, 10, b->lang ? b->lang : lang, -1, SQLITE_STATIC);
    sqlite3_bind_text(s, 11, shape, -1, SQLITE_STATIC);
    sqlite3_bind_text(s, 12, text, (int)size, SQLITE_STATIC);
    sqlite3_bind_text(s, 13, number ? NULL : b->source, -1, SQLITE_STATIC);
    sqlite3_bind_text(s, 14, b->markup, -1, SQLITE_STATIC);
    if (runs.size)
        sqlite3_bind_text(s, 15, (char *)runs.data, (int)runs.size, SQLITE_STATIC);
    if (cast_id_of_block(b, who))
        sqlite3_bind_text(s, 16, who, -1, SQLITE_STATIC);
    sqlite3_bind_text(s, 17, affect, -1, SQLITE_STATIC);
    int result = index_step(w, s, e);
    sqlite3_clear_bindings(s);
    buf_free(&runs);
    if (result >= 0 && is_found((int)b->kind, b->name)) {
        sqlite3_stmt *found = index_statement(
            w, ADD_FOUND, "INSERT INTO found (rowid, word, stem, speaker, stage) VALUES (?, ?, ?, ?, ?)");
        struct columns columns;
        columns_fill(&columns, w->stems, (int)b->kind, b->lang ? b->lang : lang, text, size);
        result = columns_write(&columns, w, found, w->next, e);
    }
    w->next++;
    return result < 0 ? -1 : 0;
}

static int add_block(struct index_writer *w, const char *work, unsigned section, const char *lang,
                     const struct block *b, const char *affect, struct error *e) {
    struct utf16_counter counter = {0};
    unsigned number = 0;
    size_t from = 0, line = 0;
    do {
        struct part part = next_part(b, from, line);
        char *shape = number ? NULL : index_shape(b);
        size_t start = b->text.size ? utf16_offset(&counter, (char *)b->text.data, part.from) : 0;
        int result = add_row(w, work, section, lang, b, &part, number, start, shape, affect, e);
        free(shape);
        if (result)
            return -1;
        number++;
        line += part.lines;
        from = part.to + (b->kind == BLOCK_VERSE && part.to < b->text.size ? 1 : 0);
    } while (from < b->text.size);
    w->characters += b->text.size;
    return 0;
}

int index_add_section(struct index_writer *w, const char *work, const char *lang,
                      const struct section *section, struct error *e) {
    int64_t first = w->next;
    struct direction_mood mood = {.lang = lang};
    for (size_t i = 0; i < section->count; i++) {
        const struct block *b = &section->blocks[i];
        direction_mood_follow(&mood, w->rules->directions, b);
        if (add_block(w, work, section->number, lang, b, *mood.who ? mood.affect : NULL, e))
            return -1;
    }
    sqlite3_stmt *s = index_statement(w, ADD_SECTION, "INSERT INTO section VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    bind_text(s, 1, work);
    sqlite3_bind_int(s, 2, (int)section->number);
    bind_text(s, 3, section->title);
    sqlite3_bind_int(s, 4, (int)section->level);
    sqlite3_bind_int(s, 5, (int)section->passages);
    sqlite3_bind_int64(s, 6, (int64_t)section->characters);
    sqlite3_bind_int64(s, 7, first);
    sqlite3_bind_int64(s, 8, w->next - 1);
    return index_step(w, s, e) < 0 ? -1 : 0;
}

/* Returns the century of the first year of three or four digits in a date, negative before the common era; 0:
 * none. */
static int century_of(const char *date) {
    for (const char *at = date; at && *at;) {
        size_t digits = strspn(at, "0123456789");
        if (digits >= 3 && digits <= 4) {
            int year = atoi(at), century = (year + 99) / 100;
            return at > date && at[-1] == '-' && (at == date + 1 || at[-2] == ' ') ? -century : century;
        }
        at += digits ? digits : 1;
    }
    return 0;
}

int index_add_work(struct index_writer *w, const char *name, const char *path, const char *hash,
                   const struct work_meta *m, int64_t first, bool recording, struct error *e) {
    sqlite3_stmt *s = index_statement(
        w, ADD_WORK,
        "INSERT INTO work SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, count(*), "
        "coalesce(sum(passages), 0), "
        "coalesce(sum(characters), 0), ?12, ?13, ?14, "
        "(SELECT CASE WHEN 2 * sum(iif(who IS NULL, 0, length(text))) > sum(length(text)) THEN "
        "'drama' WHEN 2 * sum(iif(kind = ?16, length(text), 0)) > sum(length(text)) THEN 'verse' "
        "ELSE 'prose' END FROM passage WHERE id BETWEEN ?12 AND ?13 AND kind IN (?16, ?17)), ?15, "
        "EXISTS (SELECT 1 FROM passage WHERE id BETWEEN ?12 AND ?13 AND name <> '' AND lang <> "
        "?6) FROM section WHERE work = ?1");
    const char *const texts[] = {name,    path,         hash,       m->title,  m->author, m->lang,
                                 m->date, m->publisher, m->licence, m->source, m->format};
    for (int i = 0; i < 11; i++)
        bind_text(s, i + 1, texts[i]);
    sqlite3_bind_int64(s, 12, first);
    sqlite3_bind_int64(s, 13, w->next - 1);
    sqlite3_bind_int(s, 14, recording);
    sqlite3_bind_int(s, 15, century_of(m->date));
    sqlite3_bind_int(s, 16, BLOCK_VERSE);
    sqlite3_bind_int(s, 17, BLOCK_PARAGRAPH);
    return index_step(w, s, e) < 0 ? -1 : 0;
}

int index_add_former(struct index_writer *w, const char *path, struct error *e) {
    sqlite3_stmt *s =
        index_statement(w, ADD_FORMER,
                        "INSERT OR REPLACE INTO former SELECT work, hash FROM file WHERE path = ? "
                        "AND work <> ''");
    bind_text(s, 1, path);
    return index_step(w, s, e) < 0 ? -1 : 0;
}

int index_add_cast(struct index_writer *w, const char *work, const struct cast *cast, struct error *e) {
    for (size_t i = 0; i < cast->count; i++) {
        const struct cast_member *m = &cast->members[i];
        sqlite3_stmt *s =
            index_statement(w, ADD_PERSON, "INSERT INTO person VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
        bind_text(s, 1, work);
        sqlite3_bind_int64(s, 2, (int64_t)i);
        bind_text(s, 3, m->id);
        bind_text(s, 4, m->name);
        bind_text(s, 5, m->about);
        sqlite3_bind_int(s, 6, (int)m->sex);
        sqlite3_bind_int(s, 7, (int)m->age);
        sqlite3_bind_int(s, 8, (int)m->sex_from);
        sqlite3_bind_int64(s, 9, (int64_t)m->passages);
        sqlite3_bind_int64(s, 10, (int64_t)m->characters);
        sqlite3_bind_int(s, 11, cast->told);
        bind_text(s, 12, m->first);
        if (index_step(w, s, e) < 0)
            return -1;
    }
    return 0;
}

int index_add_problem(struct index_writer *w, const char *path, const struct error *problem, bool serious,
                      struct error *e) {
    sqlite3_stmt *s = index_statement(w, ADD_PROBLEM, "INSERT INTO problem VALUES (?, ?, ?, ?, ?, ?)");
    bool place = problem->place == PLACE_LINE;
    bind_text(s, 1, path);
    bind_text(s, 2, error_name(problem->code));
    sqlite3_bind_int64(s, 3, place ? (int64_t)problem->line : 0);
    sqlite3_bind_int64(s, 4, place ? (int64_t)problem->column : 0);
    bind_text(s, 5, problem->message);
    sqlite3_bind_int(s, 6, serious);
    return index_step(w, s, e) < 0 ? -1 : 0;
}
