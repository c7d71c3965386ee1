/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sections and passages of a work: as they are shown, and as they are spoken. */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/cast.h"
#include "server/library/library_internal.h"
#include "server/library/recordings/alignments.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- sections and passages, to be shown ---- */

#define ROW_COLUMNS                                                                                          \
    "name, part, first_line, line_count, lang, shape, text, source, markup, kind, runs, who, affect"

/* Selects number, title, level, first and last row of a section, and its work. NULL with *e. The caller
 * finalises it. */
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
    error_in_field(e, ERROR_UNKNOWN_SECTION, "section", "unknown section '%.80s:%u'", work, number);
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

static json_t *passage_id(const char *work, unsigned section, const char *block) {
    return json_sprintf("%s:%u:%s", work, section, block);
}

/* Completes the stored shape: adds the text, and turns names into ids. */
static json_t *block_of(sqlite3_stmt *s, const char *work, unsigned section) {
    json_t *block = json_loads(index_text(s, 5), 0, NULL), *each;
    size_t i;
    if (!block)
        return NULL;
    if (*index_text(s, 0)) {
        json_object_set_new(block, "id", passage_id(work, section, index_text(s, 0)));
        json_object_set_new(block, "lang", library_text(s, 4));
        if (*index_text(s, 12))
            json_object_set_new(block, "affect", library_text(s, 12));
    }
    json_array_foreach(json_object_get(block, "lines"), i, each) {
        json_object_set_new(
            each, "id", json_sprintf("%s:%u:l%zu", work, section, (size_t)sqlite3_column_int64(s, 2) + i));
    }
    json_array_foreach(json_object_get(block, "marks"), i, each) {
        const char *note = json_string_value(json_object_get(each, "note"));
        if (note)
            json_object_set_new(each, "note", passage_id(work, section, note));
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
    if (text->size && sqlite3_column_int64(s, 3)) /* between the lines of a verse */
        buf_add(text, "\n", 1);
    buf_add(text, index_text(s, 6), (size_t)sqlite3_column_bytes(s, 6));
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

/* A recording that has not been looked at yet counts as waiting. */
static json_t *recording_of(struct library *l, const char *work, unsigned section) {
    json_t *recording = alignments_recording(l->alignments, work, section);
    return recording ? recording : json_pack("{ss}", "state", alignment_states[ALIGNMENT_WAITING]);
}

/* True for prose of which the narrator tells who speaks. */
static bool is_told(struct index_reader *r, const char *work, struct error *e) {
    sqlite3_stmt *s = library_prepare(r, "SELECT 1 FROM person WHERE work = ? AND told LIMIT 1", e);
    if (s)
        sqlite3_bind_text(s, 1, work, -1, SQLITE_STATIC);
    bool told = s && sqlite3_step(s) == SQLITE_ROW;
    sqlite3_finalize(s);
    return told;
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
    if (answer && is_told(r, work, e))
        cast_dialogue_blocks(json_object_get(answer, "blocks"), index_text(s, 7));
    sqlite3_finalize(s);
    sqlite3_finalize(rows); /* finalised last, so that library_reader_look sees its error */
    return answer;
}

/* A passage's place and text. */
struct found_run {
    size_t start, end; /* UTF-16 units of the text */
    char lang[36];     /* "": a stage direction, which is not spoken */
};
struct found_passage {
    char work[80], name[24]; /* name is "" for a section */
    unsigned section;
    char kind[16], block[16]; /* kind is "line" within a verse block */
    char lang[36], markup[8];
    struct buf text, source; /* source: what is spoken, if it differs from the text */
    struct found_run *runs;  /* stretches of the text in another language or not spoken; they may nest */
    size_t run_count, run_cap;
    struct cast_speech *speeches; /* adjacent ones of one speaker are joined */
    size_t speech_count, speech_cap;
    struct utf16_counter units; /* counts UTF-16 units of the text read so far */
    char n[32];
};

/* Block names are a letter and a number. */
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
        return error_in_field(e, ERROR_UNKNOWN_PASSAGE, "passage", "unknown passage '%.100s'", id);
    snprintf(p->work, sizeof p->work, "%.*s", (int)(first - id), id);
    snprintf(p->name, sizeof p->name, "%s", second ? second + 1 : "");
    p->section = (unsigned)number;
    return 0;
}

static void found_passage_free(struct found_passage *p) {
    free(p->runs);
    cast_speeches_free(p->speeches, p->speech_count);
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
    snprintf(p->block, sizeof p->block, "%s", index_text(row, 0));
    snprintf(p->lang, sizeof p->lang, "%s", index_text(row, 4));
    snprintf(p->markup, sizeof p->markup, "%s", index_text(row, 8));
    if (sqlite3_column_bytes(row, 7))
        buf_add(&p->source, index_text(row, 7), (size_t)sqlite3_column_bytes(row, 7));
}

/* Selects the rows of a section, of a block, or the row with a line. Uses an index, so the section's
 * length does not matter. */
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

/* Adds the runs of a row whose text starts at `byte` of the gathered text. */
static void add_runs(struct found_passage *p, sqlite3_stmt *row, size_t byte) {
    size_t before = utf16_offset(&p->units, (char *)p->text.data, byte);
    for (const char *at = index_text(row, 10); *at; at += strspn(at, " ")) {
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

static void add_speech(struct found_passage *p, size_t start, size_t end, const char *who,
                       const char *affect) {
    struct cast_speech *last = p->speech_count ? &p->speeches[p->speech_count - 1] : NULL;
    if (start >= end)
        return;
    if (last && last->end == start && !strcmp(last->who, who) &&
        !strcmp(last->affect ? last->affect : "", affect)) {
        last->end = end;
        return;
    }
    p->speeches = mem_grow(p->speeches, &p->speech_cap, p->speech_count + 1, sizeof *p->speeches);
    p->speeches[p->speech_count++] =
        (struct cast_speech){start, end, mem_strdup(who), *affect ? mem_strdup(affect) : NULL};
}

/* Notes who speaks a row whose text starts at `byte` of the gathered text. `runs`: the first run of the row,
 * some of which may be stage directions that the narrator speaks. */
static void add_who(struct found_passage *p, sqlite3_stmt *row, size_t byte, size_t runs, bool directions) {
    const char *who = index_text(row, 11), *affect = index_text(row, 12);
    int kind = sqlite3_column_int(row, 9);
    if (!*who || kind == BLOCK_SPEAKER || kind == BLOCK_STAGE)
        return;
    size_t at = utf16_offset(&p->units, (char *)p->text.data, byte);
    size_t end = utf16_offset(&p->units, (char *)p->text.data, p->text.size);
    for (size_t i = runs; directions && i < p->run_count; i++)
        if (!*p->runs[i].lang && p->runs[i].start >= at) {
            add_speech(p, at, p->runs[i].start, who, affect);
            at = p->runs[i].end;
        }
    add_speech(p, at, end, who, affect);
}

static void cut_speeches(struct found_passage *p, size_t from, size_t to) {
    size_t count = 0;
    for (size_t i = 0; i < p->speech_count; i++) {
        struct cast_speech speech = p->speeches[i];
        speech.start = (speech.start > from ? speech.start : from) - from;
        speech.end = (speech.end < to ? speech.end : to) - (speech.end < from ? speech.end : from);
        if (speech.end > speech.start)
            p->speeches[count++] = speech;
        else
            free(speech.who), free(speech.affect);
    }
    p->speech_count = count;
}

/* Clips the runs to [from, to) and makes them relative to `from`. */
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
    cut_speeches(p, from, to);
}

/* Reduces the text to its line `n`, from 0. */
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

/* Gathers the passage from the rows. False: it does not exist. */
static bool gather(struct found_passage *p, sqlite3_stmt *rows, const struct library_reading *how) {
    size_t line = p->name[0] == 'l' ? strtoul(p->name + 1, NULL, 10) : 0;
    bool any = false;
    while (p->text.size <= how->most && sqlite3_step(rows) == SQLITE_ROW) {
        size_t first = (size_t)sqlite3_column_int64(rows, 2), count = (size_t)sqlite3_column_int64(rows, 3);
        int kind = sqlite3_column_int(rows, 9);
        bool spoken = kind == BLOCK_HEAD || kind == BLOCK_PARAGRAPH || kind == BLOCK_VERSE ||
                      (how->names && kind == BLOCK_SPEAKER) || (how->directions && kind == BLOCK_STAGE);
        bool here = line       ? count && line >= first && line < first + count
                    : *p->name ? !strcmp(p->name, index_text(rows, 0))
                               : spoken;
        if (!here)
            continue;
        if (!any)
            set_kind(p, rows);
        if (!*p->name && any && !sqlite3_column_int64(rows, 1))
            buf_add(&p->text, "\n\n", 2);
        if (!*p->name && sqlite3_column_int64(rows, 1) == 0 && count)
            buf_add(&p->text, index_text(rows, 6), (size_t)sqlite3_column_bytes(rows, 6));
        else
            append_part(&p->text, rows);
        if (p->text.size) {
            const size_t byte = p->text.size - (size_t)sqlite3_column_bytes(rows, 6), runs = p->run_count;
            add_runs(p, rows, byte);
            add_who(p, rows, byte, runs, how->directions);
        }
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

enum { AROUND = 40 /* rows */, AROUND_BYTES = 256 << 10 };

/* Finds who speaks in the dialogue of a paragraph, by the paragraphs around it, or of a section. */
static void find_dialogue(struct index_reader *r, struct found_passage *p) {
    static const char sql[] = "SELECT text, part, name = ?3 FROM passage WHERE work = ?1 AND kind = ?4 AND "
                              "id BETWEEN (SELECT min(id) FROM passage "
                              "WHERE work = ?1 AND section = ?2 AND name = ?3) - ?5 AND (SELECT max(id) FROM "
                              "passage WHERE work = ?1 AND "
                              "section = ?2 AND name = ?3) + ?5 AND section = ?2 ORDER BY id";
    struct buf text = {0};
    struct cast_speech *speeches;
    struct utf16_counter units = {0};
    size_t count, from = SIZE_MAX;
    struct error e;
    if (!*p->name) {
        buf_add(&text, p->text.data, p->text.size);
        from = 0;
    }
    sqlite3_stmt *s = *p->name ? library_prepare(r, sql, &e) : NULL;
    if (s) {
        sqlite3_bind_text(s, 1, p->work, -1, SQLITE_STATIC);
        sqlite3_bind_int64(s, 2, p->section);
        sqlite3_bind_text(s, 3, p->name, -1, SQLITE_STATIC);
        sqlite3_bind_int(s, 4, BLOCK_PARAGRAPH);
        sqlite3_bind_int(s, 5, AROUND);
    }
    while (s && text.size < AROUND_BYTES && sqlite3_step(s) == SQLITE_ROW) {
        bool begins = !sqlite3_column_int64(s, 1);
        buf_add(&text, "\n\n", text.size && begins ? 2 : 0);
        from = begins && sqlite3_column_int(s, 2) ? text.size : from;
        buf_add(&text, index_text(s, 0), (size_t)sqlite3_column_bytes(s, 0));
    }
    sqlite3_finalize(s);
    if (from == SIZE_MAX || text.size < from + p->text.size) {
        buf_free(&text);
        return;
    }
    cast_dialogue_find((char *)text.data, text.size, p->lang, &speeches, &count);
    size_t first = utf16_offset(&units, (char *)text.data, from);
    p->speeches = speeches;
    p->speech_count = p->speech_cap = count;
    cut_speeches(p, first, utf16_offset(&units, (char *)text.data, from + p->text.size));
    buf_free(&text);
}

/* Finds a passage. Reading stops soon after `most` bytes of text. -1 with *e. */
static int find_passage(struct index_reader *r, const char *id, const struct library_reading *how,
                        struct found_passage *p, struct error *e) {
    *p = (struct found_passage){0};
    if (split(id, p, e))
        return -1;
    sqlite3_stmt *s = section_row(r, p->work, p->section, e), *rows = s ? rows_with(r, p, s, e) : NULL;
    bool bad = s && !rows, any = rows && gather(p, rows, how);
    bool prose = !*p->name || !strcmp(p->kind, "paragraph");
    if (any && how->dialogue && prose && !p->speech_count && p->text.size)
        find_dialogue(r, p);
    sqlite3_finalize(s);
    sqlite3_finalize(rows); /* finalised last, so that library_reader_look sees its error */
    if (any)
        return 0;
    found_passage_free(p);
    return bad ? -1 : error_in_field(e, ERROR_UNKNOWN_PASSAGE, "passage", "unknown passage '%.100s'", id);
}

/* Who speaks which part of the text. */
static json_t *speeches_json(const struct found_passage *p) {
    json_t *list = json_array();
    for (size_t i = 0; i < p->speech_count; i++)
        json_array_append_new(list, json_pack("{sI sI ss ss*}", "start", (json_int_t)p->speeches[i].start,
                                              "end", (json_int_t)p->speeches[i].end, "who",
                                              p->speeches[i].who, "affect", p->speeches[i].affect));
    return list;
}

/* One of two words; absent: the first. -1 with *e. */
static int read_choice(const char *field, const char *text, const char *no, const char *yes, bool *out,
                       struct error *e) {
    *out = text && !strcmp(text, yes);
    return text && !*out && strcmp(text, no) != 0
               ? error_in_field(e, ERROR_BAD_FIELD, field, "must be %s or %s", no, yes)
               : 0;
}

json_t *library_passage_json(struct index_reader *r, const struct library_question *q, struct error *e) {
    const char *id = q->passage;
    struct library_reading how = {.most = SIZE_MAX, .names = q->names};
    if (read_choice("directions", q->directions, "silent", "spoken", &how.directions, e))
        return NULL;
    struct found_passage p;
    if (find_passage(r, id, &how, &p, e))
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
        json_object_set_new(answer, "block", passage_id(p.work, p.section, p.block));
    if (answer && p.speech_count)
        json_object_set_new(answer, "speeches", speeches_json(&p));
    sqlite3_finalize(s);
    found_passage_free(&p);
    return answer;
}

/* ---- the text of a passage, to be spoken ---- */

/* Returns the voice of the work's recording, or NULL. Free it. */
static char *voice_of(const struct library *l, const char *work) {
    struct buf path = {0};
    if (!l->voices)
        return NULL;
    buf_printf(&path, "%s/%s.txt", l->voices, work);
    buf_add(&path, "", 1);
    bool there = !access((char *)path.data, R_OK);
    path.size = 0;
    buf_printf(&path, "recording:%s", work);
    buf_add(&path, "", 1);
    if (!there)
        buf_free(&path);
    return (char *)path.data;
}

/* Replaces the first `units` UTF-16 units by spaces, so that later offsets stay valid. */
static int blank(struct buf *text, double units, struct error *e) {
    struct buf out = {0};
    size_t at = 0;
    double done = 0;
    while (at < text->size && done < units) {
        uint32_t cp;
        size_t n = utf8_next((char *)text->data + at, text->size - at, &cp);
        at += n ? n : 1;
        buf_add(&out, "  ", n == 4 ? 2 : 1);
        done += n == 4 ? 2 : 1;
    }
    if (done < units || at == text->size) {
        buf_free(&out);
        return error_in_field(e, ERROR_BAD_FIELD, "from", "must be a position in the passage's text");
    }
    buf_add(&out, text->data + at, text->size - at);
    buf_free(text);
    *text = out;
    return 0;
}

/* Blanks what is not spoken, keeping byte and UTF-16 offsets. Returns the languages of the rest. */
static char *direct(struct found_passage *p, bool directions) {
    struct buf languages = {0};
    struct utf16_counter at = {0};
    for (size_t i = 0; i < p->run_count; i++) {
        const struct found_run *run = &p->runs[i];
        if (*run->lang) {
            buf_printf(&languages, "%s%zu-%zu:%s", languages.size ? " " : "", run->start, run->end,
                       run->lang);
        } else if (!directions) {
            size_t from = utf16_byte(&at, (char *)p->text.data, p->text.size, run->start);
            size_t to = utf16_byte(&at, (char *)p->text.data, p->text.size, run->end);
            utf8_blank((char *)p->text.data + from, to - from);
        }
    }
    if (languages.size)
        buf_add(&languages, "", 1);
    return (char *)languages.data;
}

int library_passage(struct library *l, const char *id, const struct library_reading *how,
                    struct library_passage *out, struct error *e) {
    static const char *const markups[] = {"apml", "jsml", "ssml", NULL};
    struct found_passage found;
    *out = (struct library_passage){.markup = "plain"};
    struct index_reader *r = library_reader(l, e);
    char *current = r ? library_current(r, id) : NULL;
    int result = r ? find_passage(r, current, how, &found, e) : -1;
    free(current);
    if (r)
        library_reader_look(r);
    if (r && r->damaged && result)
        error_plain(e, ERROR_BAD_INDEX);
    if (r)
        library_reader_done(l, r);
    if (result)
        return -1;
    bool whole = found.source.size && how->from <= 0;
    struct buf *text = whole ? &found.source : &found.text;
    out->languages = whole || !found.text.size ? NULL : direct(&found, how->directions);
    if (how->from > 0)
        result = blank(text, how->from, e);
    if (result) {
        free(out->languages);
        out->languages = NULL;
    } else {
        out->text = mem_strndup(text->size ? (char *)text->data : "", text->size);
        out->lang = mem_strdup(found.lang);
        out->voice = voice_of(l, found.work);
        out->speeches = whole ? NULL : found.speeches;
        out->speech_count = whole ? 0 : found.speech_count;
        if (!whole) {
            found.speeches = NULL;
            found.speech_count = 0;
        }
        for (const char *const *m = markups; whole && *m; m++)
            if (!strcmp(*m, found.markup))
                out->markup = *m;
    }
    found_passage_free(&found);
    return result;
}

void library_passage_free(struct library_passage *p) {
    cast_speeches_free(p->speeches, p->speech_count);
    free(p->text);
    free(p->lang);
    free(p->languages);
    free(p->voice);
    *p = (struct library_passage){0};
}
