/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sections and passages, as they are shown and spoken. */
#include "server/base/mem.h"
#include "server/library/library_internal.h"
#include "server/library/recordings/alignment_state.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROW_COLUMNS "name, part, first_line, line_count, lang, shape, text, source, markup, kind, runs"

/* The section's row: number, title, level, first and last row of its passages. NULL with *e. To be finalised.
 */
static sqlite3_stmt *section_row(struct index_reader *r, const char *work, unsigned number, struct error *e) {
    sqlite3_stmt *s =
        library_prepare(r,
                        "SELECT s.number, s.title, s.level, s.first, s.last, w.title, w.author, w.lang, "
                        "w.sections, w.recording FROM "
                        "section s JOIN work w ON w.name = s.work WHERE s.work = ? AND s.number = ?",
                        e);
    if (!s)
        return NULL;
    sqlite3_bind_text(s, 1, work, -1, SQLITE_STATIC);
    sqlite3_bind_int64(s, 2, number);
    if (sqlite3_step(s) == SQLITE_ROW)
        return s;
    sqlite3_finalize(s);
    error_in_field(e, ERROR_UNKNOWN_SECTION, "section", "there is no section '%.80s:%u'", work, number);
    return NULL;
}

static sqlite3_stmt *rows_of(struct index_reader *r, sqlite3_stmt *section, struct error *e) {
    sqlite3_stmt *s =
        library_prepare(r, "SELECT " ROW_COLUMNS " FROM passage WHERE id BETWEEN ? AND ? ORDER BY id", e);
    if (s) {
        sqlite3_bind_int64(s, 1, sqlite3_column_int64(section, 3));
        sqlite3_bind_int64(s, 2, sqlite3_column_int64(section, 4));
    }
    return s;
}

static const char *text_at(sqlite3_stmt *s, int column) {
    const char *text = (const char *)sqlite3_column_text(s, column);
    return text ? text : "";
}

static json_t *name(const char *work, unsigned section, const char *block) {
    return json_sprintf("%s:%u:%s", work, section, block);
}

/* Makes the shape whole: names become ids. */
static json_t *block_of(sqlite3_stmt *s, const char *work, unsigned section) {
    json_t *block = json_loads(text_at(s, 5), 0, NULL), *each;
    size_t i;
    if (!block)
        return NULL;
    if (*text_at(s, 0)) {
        json_object_set_new(block, "id", name(work, section, text_at(s, 0)));
        json_object_set_new(block, "lang", library_text(s, 4));
    }
    json_array_foreach(json_object_get(block, "lines"), i, each) {
        json_object_set_new(
            each, "id", json_sprintf("%s:%u:l%zu", work, section, (size_t)sqlite3_column_int64(s, 2) + i));
    }
    json_array_foreach(json_object_get(block, "marks"), i, each) {
        const char *note = json_string_value(json_object_get(each, "note"));
        if (note)
            json_object_set_new(each, "note", name(work, section, note));
    }
    return block;
}

static void set_text(json_t *block, struct buf *text) {
    if (block && text->size)
        json_object_set_new(block, "text", json_stringn((char *)text->data, text->size));
    else if (block && strcmp(json_string_value(json_object_get(block, "kind")), "page") != 0)
        json_object_set_new(block, "text", json_string(""));
    text->size = 0;
}

static void append_part(struct buf *text, sqlite3_stmt *s) {
    if (text->size && sqlite3_column_int64(s, 3)) /* of verses */
        buf_add(text, "\n", 1);
    buf_add(text, text_at(s, 6), (size_t)sqlite3_column_bytes(s, 6));
}

static json_t *blocks_of(sqlite3_stmt *rows, const char *work, unsigned section) {
    json_t *blocks = json_array(), *block = NULL;
    struct buf text = {0};
    while (sqlite3_step(rows) == SQLITE_ROW) {
        if (!sqlite3_column_int64(rows, 1)) {
            set_text(block, &text);
            block = block_of(rows, work, section);
            if (block)
                json_array_append_new(blocks, block);
        }
        append_part(&text, rows);
    }
    set_text(block, &text);
    buf_free(&text);
    return blocks;
}

/* One of which nothing is known yet waits, too. */
static json_t *recording_of(struct library *l, const char *work, unsigned section) {
    json_t *recording = alignments_recording(l->alignments, work, section);
    return recording ? recording : json_pack("{ss}", "state", alignment_states[ALIGNMENT_WAITING]);
}

json_t *library_section_json(struct library *l, struct index_reader *r, const char *work, const char *section,
                             struct error *e) {
    unsigned number;
    if (library_number("section", section, 1, SECTIONS_MAX, 0, &number, e))
        return NULL;
    sqlite3_stmt *s = section_row(r, work, number, e), *rows = s ? rows_of(r, s, e) : NULL;
    json_t *answer = NULL;
    if (rows)
        answer =
            json_pack("{so si so si so so so s{ss so so so} so}", "id", json_sprintf("%s:%u", work, number),
                      "number", (int)number, "title", library_text(s, 1), "level", sqlite3_column_int(s, 2),
                      "previous", number > 1 ? json_integer(number - 1) : json_null(), "next",
                      number < (unsigned)sqlite3_column_int(s, 8) ? json_integer(number + 1) : json_null(),
                      "recording", sqlite3_column_int(s, 9) ? recording_of(l, work, number) : json_null(),
                      "work", "id", work, "title", library_text(s, 5), "author", library_text(s, 6), "lang",
                      library_text(s, 7), "blocks", blocks_of(rows, work, number));
    sqlite3_finalize(s);
    sqlite3_finalize(rows); /* last: library_reader_look sees how it went */
    return answer;
}

/* A letter and a number. */
static bool is_name(const char *name) {
    return strchr("hpgln", *name) && name[1] >= '1' && name[1] <= '9' &&
           name[1 + strspn(name + 1, "0123456789")] == '\0';
}

/* Splits "work:section" or "work:section:name". */
static int split(const char *id, struct found_passage *p, struct error *e) {
    const char *first = strchr(id, ':'), *second = first ? strchr(first + 1, ':') : NULL;
    char *end = NULL;
    unsigned long number = first && first[1] >= '0' && first[1] <= '9' ? strtoul(first + 1, &end, 10) : 0;
    bool well = number && number <= SECTIONS_MAX &&
                (second ? end == second && second[1] && is_name(second + 1) : end && !*end) &&
                (size_t)(first - id) < sizeof p->work && (!second || strlen(second + 1) < sizeof p->name);
    if (!well)
        return error_in_field(e, ERROR_UNKNOWN_PASSAGE, "passage", "there is no passage '%.100s'", id);
    snprintf(p->work, sizeof p->work, "%.*s", (int)(first - id), id);
    snprintf(p->name, sizeof p->name, "%s", second ? second + 1 : "");
    p->section = (unsigned)number;
    return 0;
}

void found_passage_free(struct found_passage *p) {
    free(p->runs);
    buf_free(&p->text);
    buf_free(&p->source);
}

static void set_kind(struct found_passage *p, sqlite3_stmt *row) {
    static const char *const kinds[] = {[BLOCK_HEAD] = "head",
                                        [BLOCK_PARAGRAPH] = "paragraph",
                                        [BLOCK_VERSE] = "verse",
                                        [BLOCK_NOTE] = "note"};
    int kind = sqlite3_column_int(row, 9);
    snprintf(p->kind, sizeof p->kind, "%s", kind <= BLOCK_NOTE ? kinds[kind] : "");
    snprintf(p->block, sizeof p->block, "%s", text_at(row, 0));
    snprintf(p->lang, sizeof p->lang, "%s", text_at(row, 4));
    snprintf(p->markup, sizeof p->markup, "%s", text_at(row, 8));
    if (sqlite3_column_bytes(row, 7))
        buf_add(&p->source, text_at(row, 7), (size_t)sqlite3_column_bytes(row, 7));
}

/* The rows that the passage is in: those of a section, of a block, or the one with a line. However long the
 * section is, those of a block are found at once. */
static sqlite3_stmt *rows_with(struct index_reader *r, const struct found_passage *p, sqlite3_stmt *section,
                               struct error *e) {
    bool line = p->name[0] == 'l';
    if (!*p->name)
        return rows_of(r, section, e);
    sqlite3_stmt *s = library_prepare(
        r,
        line ? "SELECT " ROW_COLUMNS " FROM passage WHERE work = ? AND section = ? AND line_count > 0 AND "
               "first_line <= ? ORDER BY first_line DESC LIMIT 1"
             : "SELECT " ROW_COLUMNS " FROM passage WHERE work = ? AND section = ? AND name = ? ORDER BY id",
        e);
    if (!s)
        return NULL;
    sqlite3_bind_text(s, 1, p->work, -1, SQLITE_STATIC);
    sqlite3_bind_int64(s, 2, p->section);
    if (line)
        sqlite3_bind_int64(s, 3, (sqlite3_int64)strtoul(p->name + 1, NULL, 10));
    else
        sqlite3_bind_text(s, 3, p->name, -1, SQLITE_STATIC);
    return s;
}

/* The row's runs, whose text begins at that byte of what is gathered. */
static void add_runs(struct found_passage *p, sqlite3_stmt *row, size_t byte) {
    size_t before = utf16_offset(&p->units, (char *)p->text.data, byte);
    for (const char *at = text_at(row, 10); *at; at += strspn(at, " ")) {
        size_t size = strcspn(at, " ");
        unsigned long start, end;
        struct found_run run = {0};
        int lang = 0;
        if (sscanf(at, "%lu-%lu:%n", &start, &end, &lang) == 2 && lang && (size_t)lang <= size) {
            run.start = before + start;
            run.end = before + end;
            snprintf(run.lang, sizeof run.lang, "%.*s", (int)(size - (size_t)lang), at + lang);
            p->runs = mem_grow(p->runs, &p->run_cap, p->run_count + 1, sizeof run);
            p->runs[p->run_count++] = run;
        }
        at += size;
    }
}

/* Keeps of the runs what is between two places, and counts from the first. */
static void cut_runs(struct found_passage *p, size_t from, size_t to) {
    size_t count = 0;
    for (size_t i = 0; i < p->run_count; i++) {
        struct found_run run = p->runs[i];
        run.start = (run.start > from ? run.start : from) - from;
        run.end = (run.end < to ? run.end : to) - (run.end < from ? run.end : from);
        if (run.end > run.start)
            p->runs[count++] = run;
    }
    p->run_count = count;
}

/* The nth line of the text, from 0, alone. */
static void keep_line(struct found_passage *p, size_t n) {
    struct buf *text = &p->text;
    struct utf16_counter units = {0};
    size_t from = 0;
    for (; n && from < text->size; from++)
        n -= text->data[from] == '\n';
    const uint8_t *end = text->size > from ? memchr(text->data + from, '\n', text->size - from) : NULL;
    size_t to = end ? (size_t)(end - text->data) : text->size;
    size_t first = from ? utf16_offset(&units, (char *)text->data, from) : 0;
    if (text->size)
        cut_runs(p, first, utf16_offset(&units, (char *)text->data, to));
    text->size = to;
    buf_consume(text, from);
}

/* Gathers from the rows; true when there was any. */
static bool gather(struct found_passage *p, sqlite3_stmt *rows, size_t most) {
    size_t line = p->name[0] == 'l' ? strtoul(p->name + 1, NULL, 10) : 0;
    bool any = false;
    while (p->text.size <= most && sqlite3_step(rows) == SQLITE_ROW) {
        size_t first = (size_t)sqlite3_column_int64(rows, 2), count = (size_t)sqlite3_column_int64(rows, 3);
        int kind = sqlite3_column_int(rows, 9);
        bool spoken = kind == BLOCK_HEAD || kind == BLOCK_PARAGRAPH || kind == BLOCK_VERSE;
        bool here = line       ? count && line >= first && line < first + count
                    : *p->name ? !strcmp(p->name, text_at(rows, 0))
                               : spoken;
        if (!here)
            continue;
        if (!any)
            set_kind(p, rows);
        if (!*p->name && any && !sqlite3_column_int64(rows, 1))
            buf_add(&p->text, "\n\n", 2);
        if (!*p->name && sqlite3_column_int64(rows, 1) == 0 && count)
            buf_add(&p->text, text_at(rows, 6), (size_t)sqlite3_column_bytes(rows, 6));
        else
            append_part(&p->text, rows);
        if (p->text.size)
            add_runs(p, rows, p->text.size - (size_t)sqlite3_column_bytes(rows, 6));
        any = true;
        if (line) {
            keep_line(p, line - first);
            snprintf(p->kind, sizeof p->kind, "line");
            break;
        }
    }
    if (!*p->name)
        snprintf(p->kind, sizeof p->kind, "section");
    return any;
}

int library_find(struct index_reader *r, const char *id, size_t most, struct found_passage *p,
                 struct error *e) {
    *p = (struct found_passage){0};
    if (split(id, p, e))
        return -1;
    sqlite3_stmt *s = section_row(r, p->work, p->section, e), *rows = s ? rows_with(r, p, s, e) : NULL;
    bool bad = s && !rows, any = rows && gather(p, rows, most);
    sqlite3_finalize(s);
    sqlite3_finalize(rows); /* last: library_reader_look sees how it went */
    if (any)
        return 0;
    found_passage_free(p);
    return bad ? -1 : error_in_field(e, ERROR_UNKNOWN_PASSAGE, "passage", "there is no passage '%.100s'", id);
}

json_t *library_passage_json(struct index_reader *r, const char *id, struct error *e) {
    struct found_passage p;
    if (library_find(r, id, SIZE_MAX, &p, e))
        return NULL;
    sqlite3_stmt *s = section_row(r, p.work, p.section, e);
    json_t *answer = NULL;
    if (s)
        answer =
            json_pack("{ss ss ss so s{so si so} s{ss so so so} sb}", "id", id, "kind", p.kind, "lang", p.lang,
                      "text", json_stringn(p.text.size ? (char *)p.text.data : "", p.text.size), "section",
                      "id", json_sprintf("%s:%u", p.work, p.section), "number", (int)p.section, "title",
                      library_text(s, 1), "work", "id", p.work, "title", library_text(s, 5), "author",
                      library_text(s, 6), "lang", library_text(s, 7), "recording", sqlite3_column_int(s, 9));
    if (answer && *p.name)
        json_object_set_new(answer, "block", name(p.work, p.section, p.block));
    sqlite3_finalize(s);
    found_passage_free(&p);
    return answer;
}
