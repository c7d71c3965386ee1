/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/utf8.h"
#include "server/library/index_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Statements by number: see index_statement. */
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
    DROP_PROBLEMS,
    ADD_ROW,
    ADD_FOUND,
    ADD_SECTION,
    ADD_WORK,
    ADD_PROBLEM,
};

static void bind_text(sqlite3_stmt *s, int at, const char *text) {
    sqlite3_bind_text(s, at, text, -1, SQLITE_TRANSIENT);
}

static const char *text_at(sqlite3_stmt *s, int column) {
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
        snprintf(out->hash, sizeof out->hash, "%s", text_at(s, 2));
        snprintf(out->work, sizeof out->work, "%s", text_at(s, 3));
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

/* The rows' words have to be told again for the index to forget them. */
static int remove_rows(struct index_writer *w, int64_t first, int64_t last, struct error *e) {
    sqlite3_stmt *rows = index_statement(
        w, GET_ROWS, "SELECT id, lang, text FROM passage WHERE id BETWEEN ? AND ? AND name <> ''");
    int result;
    sqlite3_bind_int64(rows, 1, first);
    sqlite3_bind_int64(rows, 2, last);
    while ((result = index_step(w, rows, e)) == 1) {
        struct buf words = {0}, stems = {0};
        sqlite3_stmt *drop = index_statement(
            w, DROP_FOUND, "INSERT INTO found (found, rowid, word, stem) VALUES ('delete', ?, ?, ?)");
        index_columns(w->stems, text_at(rows, 1), text_at(rows, 2), (size_t)sqlite3_column_bytes(rows, 2),
                      &words, &stems);
        sqlite3_bind_int64(drop, 1, sqlite3_column_int64(rows, 0));
        sqlite3_bind_text(drop, 2, words.size ? (char *)words.data : "", (int)words.size, SQLITE_TRANSIENT);
        sqlite3_bind_text(drop, 3, stems.size ? (char *)stems.data : "", (int)stems.size, SQLITE_TRANSIENT);
        result = index_step(w, drop, e);
        buf_free(&words);
        buf_free(&stems);
        if (result < 0) {
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
            drop(w, DROP_WORK, "DELETE FROM work WHERE name = ?", file.work, e))
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

/* The next part of a block's text, from `from` on. */
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

/* What of the part is in another language or not spoken: "START-END:LANG ", in UTF-16 units of the part; a
 * stage direction has no language. */
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
                   struct error *e) {
    const char *text = b->text.size ? (const char *)b->text.data + part->from : "";
    size_t size = part->to - part->from;
    struct buf runs = {0};
    runs_of(b, part, &runs);
    sqlite3_stmt *s = index_statement(
        w, ADD_ROW, "INSERT INTO passage VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
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
    int result = index_step(w, s, e);
    sqlite3_clear_bindings(s);
    buf_free(&runs);
    if (result >= 0 && *b->name) {
        struct buf words = {0}, stems = {0};
        sqlite3_stmt *found =
            index_statement(w, ADD_FOUND, "INSERT INTO found (rowid, word, stem) VALUES (?, ?, ?)");
        index_columns(w->stems, b->lang ? b->lang : lang, text, size, &words, &stems);
        sqlite3_bind_int64(found, 1, w->next);
        sqlite3_bind_text(found, 2, words.size ? (char *)words.data : "", (int)words.size, SQLITE_STATIC);
        sqlite3_bind_text(found, 3, stems.size ? (char *)stems.data : "", (int)stems.size, SQLITE_STATIC);
        result = index_step(w, found, e);
        sqlite3_clear_bindings(found);
        buf_free(&words);
        buf_free(&stems);
    }
    w->next++;
    return result < 0 ? -1 : 0;
}

static int add_block(struct index_writer *w, const char *work, unsigned section, const char *lang,
                     const struct block *b, struct error *e) {
    struct utf16_counter counter = {0};
    unsigned number = 0;
    size_t from = 0, line = 0;
    do {
        struct part part = next_part(b, from, line);
        char *shape = number ? NULL : index_shape(b);
        size_t start = b->text.size ? utf16_offset(&counter, (char *)b->text.data, part.from) : 0;
        int result = add_row(w, work, section, lang, b, &part, number, start, shape, e);
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
    for (size_t i = 0; i < section->count; i++)
        if (add_block(w, work, section->number, lang, &section->blocks[i], e))
            return -1;
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

int index_add_work(struct index_writer *w, const char *name, const char *path, const char *hash,
                   const struct work_meta *m, int64_t first, bool recording, struct error *e) {
    sqlite3_stmt *s =
        index_statement(w, ADD_WORK,
                        "INSERT INTO work SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, count(*), "
                        "coalesce(sum(passages), 0), "
                        "coalesce(sum(characters), 0), ?12, ?13, ?14 FROM section WHERE work = ?1");
    const char *const texts[] = {name,    path,         hash,       m->title,  m->author, m->lang,
                                 m->date, m->publisher, m->licence, m->source, m->format};
    for (int i = 0; i < 11; i++)
        bind_text(s, i + 1, texts[i]);
    sqlite3_bind_int64(s, 12, first);
    sqlite3_bind_int64(s, 13, w->next - 1);
    sqlite3_bind_int(s, 14, recording);
    return index_step(w, s, e) < 0 ? -1 : 0;
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
