/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/works/readers.h"
#include "server/library/works/work.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <utf8proc.h>

void block_spoken(const struct block *block, struct buf *out) {
    size_t from = out->size;
    buf_add(out, block->text.data, block->text.size);
    for (size_t i = 0; i < block->mark_count; i++) {
        const struct block_mark *m = &block->marks[i];
        if (m->kind == MARK_STAGE && m->start < m->end && m->end <= block->text.size)
            utf8_blank((char *)out->data + from + m->start, m->end - m->start);
    }
}

static void block_free(struct block *b) {
    for (size_t i = 0; i < b->mark_count; i++)
        free(b->marks[i].value);
    for (size_t i = 0; i < b->line_count; i++)
        free(b->lines[i].n);
    free(b->marks);
    free(b->lines);
    free(b->lang);
    free(b->speaker);
    free(b->who);
    free(b->n);
    free(b->source);
    buf_free(&b->text);
    *b = (struct block){0};
}

void section_free(struct section *s) {
    for (size_t i = 0; i < s->count; i++)
        block_free(&s->blocks[i]);
    free(s->blocks);
    free(s->title);
    *s = (struct section){.level = 1};
}

enum { NAME_BYTES_MAX = 200 }; /* bytes of a speaker's name or a number, which each block may repeat */

/* Approximate size in the index of a block, a line and a mark, without the text. */
enum { BLOCK_WEIGHT = 200, LINE_WEIGHT = 64, MARK_WEIGHT = 64 };

static const char letters[] = {
    [BLOCK_HEAD] = 'h',  [BLOCK_PARAGRAPH] = 'p', [BLOCK_VERSE] = 'g', [BLOCK_NOTE] = 'n',
    [BLOCK_SPEAKER] = 0, [BLOCK_STAGE] = 0,       [BLOCK_PAGE] = 0};

void builder_open(struct builder *b, const struct work_sink *sink) {
    *b = (struct builder){.sink = sink, .section = {.level = 1}, .bytes_max = WORK_BYTES_MAX};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &b->begun);
}

void builder_allow(struct builder *b, uint64_t file_bytes) {
    if (file_bytes > b->bytes_max / WORK_BYTES_FACTOR)
        b->bytes_max = WORK_BYTES_FACTOR * file_bytes;
}

static void place_of(const struct builder *b, struct error *e) {
    if (!b->where)
        return;
    e->place = PLACE_LINE;
    b->where(b->where_ctx, &e->line, &e->column);
}

static void stop(struct builder *b, const char *format, int most) {
    if (b->stopped)
        return;
    b->stopped = true;
    error_set(&b->why, ERROR_BAD_WORK, format, most);
    place_of(b, &b->why);
}

/* Adds to the work's size. False: the limit is reached, and nothing more is accepted. */
static bool weigh(struct builder *b, size_t bytes) {
    b->bytes += bytes;
    if (b->bytes > b->bytes_max)
        stop(b, "the limit for a work is %d MiB of the index: the rest is dropped",
             (int)(b->bytes_max >> 20));
    return !b->stopped;
}

static void look_at_clock(struct builder *b) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    if (now.tv_sec - b->begun.tv_sec > WORK_SECONDS_MAX)
        stop(b, "the limit for reading a work is %d seconds: the rest is dropped", WORK_SECONDS_MAX);
}

int builder_why(const struct builder *b, struct error *e) {
    if (b->why.code == ERROR_NONE)
        return error_set(e, ERROR_BAD_WORK, "it was read only in part");
    *e = b->why;
    return -1;
}

/* Copies the text, cut to NAME_BYTES_MAX. */
static char *name_of(const char *text) {
    char *name = mem_strndup(text, strnlen(text, NAME_BYTES_MAX));
    utf8_mend(name);
    return name;
}

static void flush(struct builder *b, bool last) {
    struct section *s = &b->section;
    if (s->count && !b->stopped) {
        s->number = ++b->sections;
        weigh(b, BLOCK_WEIGHT);
        if (b->sink->section(b->sink->ctx, s))
            b->stopped = true;
        if (b->sections >= SECTIONS_MAX && !last)
            stop(b, "the limit for a work is %d sections: the rest is dropped", SECTIONS_MAX);
        look_at_clock(b);
    }
    section_free(s);
}

int builder_close(struct builder *b) {
    while (b->depth)
        build_end(b);
    flush(b, true);
    free(b->speaker);
    free(b->who);
    free(b->pending);
    return b->stopped ? -1 : 0;
}

void build_section(struct builder *b, unsigned level) {
    while (b->depth)
        build_end(b);
    flush(b, false);
    b->section.level = level;
}

static void append(struct section *s, struct block *block) {
    s->blocks = mem_grow(s->blocks, &s->cap, s->count + 1, sizeof *s->blocks);
    s->blocks[s->count++] = *block;
}

/* Sets the block's name and numbers from its position in the section. */
static void name_block(struct builder *b, struct block *block) {
    struct section *s = &b->section;
    unsigned count = ++s->counts[block->kind];
    if (letters[block->kind])
        snprintf(block->name, sizeof block->name, "%c%u", letters[block->kind], count);
    if (letters[block->kind] && block->kind != BLOCK_NOTE && b->speaker && !block->speaker)
        block->speaker = mem_strdup(b->speaker);
    if (letters[block->kind] && block->kind != BLOCK_NOTE && b->who && !block->who)
        block->who = mem_strdup(b->who);
}

static struct block *open_block(struct builder *b, enum block_kind kind) {
    struct block *block = mem_alloc(sizeof *block);
    block->kind = kind;
    block->lang = b->lang && *b->lang ? mem_strdup(b->lang) : NULL;
    block->level = b->section.level;
    name_block(b, block);
    b->open[b->depth++] = block;
    b->space = b->soft = b->cut = false;
    b->line_break = BREAK_NONE;
    if (weigh(b, BLOCK_WEIGHT + (block->speaker ? strlen(block->speaker) : 0) +
                     (block->who ? strlen(block->who) : 0)))
        look_at_clock(b);
    return block;
}

void build_block(struct builder *b, enum block_kind kind) {
    while (b->depth)
        build_end(b);
    open_block(b, kind);
}

bool build_is_open(const struct builder *b) {
    return b->depth;
}

struct block *build_top(struct builder *b) {
    return b->depth ? b->open[b->depth - 1] : NULL;
}

enum block_kind build_kind(const struct builder *b) {
    return b->open[b->depth - 1]->kind;
}

/* Starts a continuation of the section under the same title. */
static void divide(struct builder *b) {
    char *title = b->section.title ? mem_strdup(b->section.title) : NULL;
    unsigned level = b->section.level;
    flush(b, false);
    b->section.level = level;
    b->section.title = title;
}

/* Gives a verse that is divided between speakers one number: its later lines have the number of the first,
 * and the lines after it count on from there. */
static void number_lines(struct section *s, struct block *block, char verse[24]) {
    for (size_t i = 0; i < block->line_count; i++) {
        struct block_line *line = &block->lines[i];
        line->goes_on = line->goes_on && s->lines + i > 0;
        s->continued += line->goes_on;
        if (!line->n && line->goes_on && *verse) {
            line->n = mem_strdup(verse);
        } else if (!line->n && s->continued) {
            char number[24];
            snprintf(number, sizeof number, "%zu", s->lines + i + 1 - s->continued);
            line->n = mem_strdup(number);
        }
        if (line->n)
            snprintf(verse, 24, "%.23s", line->n);
        else
            snprintf(verse, 24, "%zu", s->lines + i + 1);
    }
}

static void place(struct builder *b, struct block *block) {
    struct section *s = &b->section;
    if (!block->text.size && block->kind != BLOCK_PAGE) {
        if (letters[block->kind] && block->kind != BLOCK_NOTE)
            s->counts[block->kind]--;
        block_free(block);
        return;
    }
    if (block->kind == BLOCK_HEAD && !s->title)
        s->title = mem_strndup((char *)block->text.data, block->text.size > 200 ? 200 : block->text.size);
    if (block->kind == BLOCK_HEAD && s->title)
        utf8_mend(s->title);
    if (block->kind == BLOCK_VERSE) {
        block->first_line = s->lines + 1;
        number_lines(s, block, b->verse);
        s->lines += (unsigned)block->line_count;
    }
    s->passages += letters[block->kind] != 0;
    s->characters += letters[block->kind] ? block->text.size : 0;
    append(s, block);
}

void build_end(struct builder *b) {
    if (!b->depth)
        return;
    struct block *block = b->open[--b->depth];
    b->space = b->soft = false;
    b->line_break = BREAK_NONE;
    if (block->kind == BLOCK_VERSE && block->line_count) {
        struct block_line *line = &block->lines[block->line_count - 1];
        line->end = block->text.size;
        if (line->end == line->start && --block->line_count && block->text.size)
            block->text.size--; /* the newline before it */
        if (line->end == line->start)
            free(line->n);
    }
    for (size_t i = 0; i < block->mark_count;
         i++) { /* marks that are still open, and those of the removed line */
        struct block_mark *mark = &block->marks[i];
        mark->start = mark->start < block->text.size ? mark->start : block->text.size;
        mark->end = mark->end < block->text.size ? mark->end : block->text.size;
    }
    if (b->depth) { /* an inset follows the block that contains it */
        b->pending = mem_grow(b->pending, &b->pending_cap, b->pending_count + 1, sizeof *b->pending);
        b->pending[b->pending_count++] = *block;
        free(block);
        return;
    }
    place(b, block);
    for (size_t i = 0; i < b->pending_count; i++)
        place(b, &b->pending[i]);
    b->pending_count = 0;
    free(block);
    if (b->section.characters > SECTION_CHARACTERS)
        divide(b);
}

/* Returns the block to append to. A block that is too long continues in another of its kind; inside
 * another block the rest is dropped and reported. */
static struct block *room_for(struct builder *b, size_t size) {
    struct block *block = build_top(b);
    if (block->text.size + size <= BLOCK_BYTES_MAX)
        return block;
    if (b->depth == 1 && block->kind == BLOCK_VERSE)
        build_line(b, NULL, false);
    else if (b->depth == 1 && block->kind != BLOCK_SPEAKER)
        build_block(b, block->kind);
    block = build_top(b);
    if (block->text.size + size <= BLOCK_BYTES_MAX)
        return block;
    if (!b->cut) {
        struct error e;
        error_set(&e, ERROR_BAD_WORK,
                  "the limit for a note, a name or a word is %d bytes: the rest is dropped", BLOCK_BYTES_MAX);
        place_of(b, &e);
        build_problem(b, &e, true);
    }
    b->cut = true;
    return NULL;
}

static void put(struct builder *b, const char *text, size_t size) {
    struct block *block = weigh(b, size) ? room_for(b, size) : NULL;
    if (block)
        buf_add(&block->text, text, size);
}

void build_cut(struct builder *b, size_t size) {
    struct block *block = build_top(b);
    if (!block || block->text.size <= size)
        return;
    block->text.size = size;
    for (size_t i = 0; i < block->mark_count; i++) {
        struct block_mark *mark = &block->marks[i];
        mark->start = mark->start < size ? mark->start : size;
        mark->end = mark->end == (size_t)-1 || mark->end < size ? mark->end : size;
    }
}

/* Returns the character that ends at `end`, and its length. */
static uint32_t before(const struct block *block, size_t end, size_t *length) {
    size_t at = end;
    uint32_t cp = 0;
    while (at && (block->text.data[--at] & 0xC0) == 0x80)
        ;
    *length = end - at;
    if (end)
        utf8_next((const char *)block->text.data + at, end - at, &cp);
    return cp;
}

static bool is_letter(uint32_t cp) {
    int category = utf8proc_category((utf8proc_int32_t)cp);
    return cp && category >= UTF8PROC_CATEGORY_LU && category <= UTF8PROC_CATEGORY_MN;
}

static bool is_figure(uint32_t cp) {
    return utf8proc_category((utf8proc_int32_t)cp) == UTF8PROC_CATEGORY_ND;
}

/* Length in bytes of the hyphen that the text ends with, after a letter; 0: none. */
static size_t hyphen_of(const struct block *block) {
    size_t length = 0, other;
    uint32_t cp = before(block, block->text.size, &length);
    bool hyphen = cp == '-' || cp == 0x2010 || cp == 0xAC || cp == 0x2E17;
    return hyphen && is_letter(before(block, block->text.size - length, &other)) ? length : 0;
}

void build_break(struct builder *b, bool join) {
    if (!b->depth)
        return;
    if (join || (b->soft && !b->space))
        b->line_break = BREAK_JOINS;
    else if (!b->space && hyphen_of(build_top(b)))
        b->line_break = BREAK_HYPHEN;
    else
        b->space = true;
    if (b->line_break != BREAK_NONE)
        b->space = false;
}

void build_apart(struct builder *b) {
    if (b->depth && b->line_break == BREAK_NONE)
        b->line_break = BREAK_APART;
}

void build_join_cells(struct builder *b) {
    const struct block *block = build_top(b);
    if (!block || !block->text.size)
        return;
    b->line_break = BREAK_NONE;
    b->space = false;
    if (!strchr(".,;:!?\n", block->text.data[block->text.size - 1]))
        put(b, ";", 1);
    b->space = true;
}

/* Resolves a pending line break now that the following text is known. */
static void end_break(struct builder *b, const char *text, size_t size) {
    struct block *block = build_top(b);
    size_t length;
    uint32_t cp = 0;
    utf8_next(text, size, &cp);
    if (b->line_break == BREAK_JOINS ||
        (b->line_break == BREAK_HYPHEN && utf8proc_category((utf8proc_int32_t)cp) == UTF8PROC_CATEGORY_LL))
        build_cut(b, block->text.size - hyphen_of(block));
    uint32_t last = before(block, block->text.size, &length);
    bool point = last && last < 0x80 && strchr(".,;:!?", (int)last);
    if (b->line_break == BREAK_APART && (is_letter(last) || is_figure(last) || point) &&
        (is_letter(cp) || is_figure(cp)))
        b->space = true;
    b->line_break = BREAK_NONE;
}

/* Length of a soft hyphen or zero-width break opportunity at `text`; 0: none. */
static size_t unseen(const char *text, size_t left) {
    static const char *const signs[] = {"\xC2\xAD", "\xE2\x80\x8B", "\xE2\x81\xA0", "\xEF\xBB\xBF"};
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++) {
        size_t length = strlen(signs[i]);
        if (left >= length && !memcmp(text, signs[i], length))
            return length;
    }
    return 0;
}

static bool is_white(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static bool at_start(const struct block *block) {
    return !block->text.size || block->text.data[block->text.size - 1] == '\n';
}

void build_text(struct builder *b, const char *text, size_t size) {
    if (!b->depth)
        return;
    if (b->keep) {
        put(b, text, size);
        return;
    }
    for (size_t i = 0; i < size && !b->stopped;) {
        size_t hidden = unseen(text + i, size - i);
        if (hidden) {
            b->soft = text[i] == '\xC2';
            i += hidden;
            continue;
        }
        if (is_white(text[i])) {
            b->space = b->line_break != BREAK_JOINS && b->line_break != BREAK_HYPHEN;
            i++;
            continue;
        }
        size_t end = i;
        while (end < size && !is_white(text[end]) && !unseen(text + end, size - end))
            end++;
        end_break(b, text + i, end - i);
        if (b->space && !at_start(build_top(b)))
            put(b, " ", 1);
        b->space = b->soft = false;
        if (b->depth)
            put(b, text + i, end - i);
        i = end;
    }
}

void build_newline(struct builder *b) {
    struct block *block = build_top(b);
    b->space = b->soft = false;
    b->line_break = BREAK_NONE;
    if (block && !at_start(block))
        put(b, "\n", 1);
}

void build_mark(struct builder *b, enum mark_kind kind, const char *value) {
    struct block *block = build_top(b);
    if (!block || !weigh(b, MARK_WEIGHT))
        return;
    if (b->space && !at_start(block))
        put(b, " ", 1);
    b->space = false;
    block = build_top(b);
    bool point = kind == MARK_NOTE || kind == MARK_PAGE;
    block->marks = mem_grow(block->marks, &block->mark_cap, block->mark_count + 1, sizeof *block->marks);
    block->marks[block->mark_count++] = (struct block_mark){
        kind, block->text.size, point ? block->text.size : (size_t)-1, value ? name_of(value) : NULL};
}

void build_mark_end(struct builder *b, enum mark_kind kind) {
    struct block *block = build_top(b);
    for (size_t i = block ? block->mark_count : 0; i-- > 0;)
        if (block->marks[i].kind == kind && block->marks[i].end == (size_t)-1) {
            block->marks[i].end = block->text.size;
            return;
        }
}

void build_line(struct builder *b, const char *n, bool indent) {
    struct block *block = build_top(b);
    if (!block || block->kind != BLOCK_VERSE) {
        build_block(b, BLOCK_VERSE);
        block = build_top(b);
    }
    build_line_end(b);
    if (!weigh(b, LINE_WEIGHT))
        return;
    if (block->text.size > BLOCK_BYTES_MAX / 2) {
        build_block(b, BLOCK_VERSE);
        block = build_top(b);
    }
    if (block->line_count && block->lines[block->line_count - 1].start == block->text.size)
        free(block->lines[--block->line_count].n); /* the line stayed empty */
    else if (block->text.size)
        put(b, "\n", 1);
    block->lines = mem_grow(block->lines, &block->line_cap, block->line_count + 1, sizeof *block->lines);
    block->lines[block->line_count++] = (struct block_line){
        .start = block->text.size, .end = block->text.size, .n = n ? name_of(n) : NULL, .indent = indent};
}

void build_line_goes_on(struct builder *b) {
    struct block *block = build_top(b);
    if (!block || !block->line_count)
        return;
    block->lines[block->line_count - 1].indent = true;
    block->lines[block->line_count - 1].goes_on = true;
}

void build_line_end(struct builder *b) {
    struct block *block = build_top(b);
    b->space = b->soft = false;
    b->line_break = BREAK_NONE;
    if (block && block->line_count)
        block->lines[block->line_count - 1].end = block->text.size;
}

void build_inset(struct builder *b, enum block_kind kind, const char *n) {
    if (b->depth == NOTE_DEPTH_MAX)
        build_end(b);
    b->waits[b->depth] = b->space;
    struct block *host = build_top(b), *block = open_block(b, kind);
    block->n = n ? name_of(n) : NULL;
    if (host && kind == BLOCK_NOTE) {
        host->marks = mem_grow(host->marks, &host->mark_cap, host->mark_count + 1, sizeof *host->marks);
        host->marks[host->mark_count++] =
            (struct block_mark){MARK_NOTE, host->text.size, host->text.size, mem_strdup(block->name)};
    }
}

void build_inset_end(struct builder *b) {
    if (!b->depth)
        return;
    bool waits = b->waits[b->depth - 1];
    build_end(b);
    b->space = waits && b->depth;
}

void build_page(struct builder *b, const char *n) {
    if (b->depth) {
        build_mark(b, MARK_PAGE, n ? n : "");
        return;
    }
    struct block *page = open_block(b, BLOCK_PAGE);
    page->n = name_of(n ? n : "");
    build_end(b);
}

void build_speaker(struct builder *b, const char *name) {
    free(b->speaker);
    b->speaker = name && *name ? name_of(name) : NULL;
}

void build_who(struct builder *b, const char *who) {
    free(b->who);
    b->who = who && *who ? name_of(who) : NULL;
}

void build_problem(struct builder *b, const struct error *e, bool serious) {
    if (b->told++ < PROBLEMS_MAX)
        b->sink->problem(b->sink->ctx, e, serious);
}
