/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/builder.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char letters[] = {
    [BLOCK_HEAD] = 'h',  [BLOCK_PARAGRAPH] = 'p', [BLOCK_VERSE] = 'g', [BLOCK_NOTE] = 'n',
    [BLOCK_SPEAKER] = 0, [BLOCK_STAGE] = 0,       [BLOCK_PAGE] = 0};

void builder_open(struct builder *b, const struct work_sink *sink) {
    *b = (struct builder){.sink = sink, .section = {.level = 1}};
}

static void flush(struct builder *b, bool last) {
    struct section *s = &b->section;
    if (s->count && !b->stopped) {
        s->number = ++b->sections;
        b->stopped = b->sink->section(b->sink->ctx, s) || (b->sections >= SECTIONS_MAX && !last);
    }
    section_free(s);
}

int builder_close(struct builder *b) {
    while (b->depth)
        build_end(b);
    flush(b, true);
    free(b->speaker);
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

/* Sets what follows from its place in the section. */
static void name_block(struct builder *b, struct block *block) {
    struct section *s = &b->section;
    unsigned count = ++s->counts[block->kind];
    if (letters[block->kind])
        snprintf(block->name, sizeof block->name, "%c%u", letters[block->kind], count);
    if (letters[block->kind] && block->kind != BLOCK_NOTE && b->speaker && !block->speaker)
        block->speaker = mem_strdup(b->speaker);
}

static struct block *open_block(struct builder *b, enum block_kind kind) {
    struct block *block = mem_alloc(sizeof *block);
    block->kind = kind;
    block->lang = b->lang && *b->lang ? mem_strdup(b->lang) : NULL;
    block->level = b->section.level;
    name_block(b, block);
    b->open[b->depth++] = block;
    b->space = false;
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

/* A continued section has the title of its beginning. */
static void divide(struct builder *b) {
    char *title = b->section.title ? mem_strdup(b->section.title) : NULL;
    unsigned level = b->section.level;
    flush(b, false);
    b->section.level = level;
    b->section.title = title;
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
    b->space = false;
    if (block->kind == BLOCK_VERSE && block->line_count) {
        struct block_line *line = &block->lines[block->line_count - 1];
        line->end = block->text.size;
        if (line->end == line->start && --block->line_count && block->text.size)
            block->text.size--; /* the newline before it */
        if (line->end == line->start)
            free(line->n);
    }
    for (size_t i = 0; i < block->mark_count; i++) { /* open ones, and those of the line that has gone */
        struct block_mark *mark = &block->marks[i];
        mark->start = mark->start < block->text.size ? mark->start : block->text.size;
        mark->end = mark->end < block->text.size ? mark->end : block->text.size;
    }
    if (b->depth) { /* an inset: behind the block that it stands in */
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

static void put(struct builder *b, const char *text, size_t size) {
    struct block *block = build_top(b);
    if (block->text.size + size > BLOCK_BYTES_MAX && b->depth == 1 && block->kind == BLOCK_PARAGRAPH) {
        build_block(b, BLOCK_PARAGRAPH);
        block = build_top(b);
    }
    if (block->text.size + size <= BLOCK_BYTES_MAX)
        buf_add(&block->text, text, size);
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
    for (size_t i = 0; i < size;) {
        if (is_white(text[i])) {
            b->space = true;
            i++;
            continue;
        }
        size_t end = i;
        while (end < size && !is_white(text[end]))
            end++;
        if (b->space && !at_start(build_top(b)))
            put(b, " ", 1);
        b->space = false;
        put(b, text + i, end - i);
        i = end;
    }
}

void build_newline(struct builder *b) {
    struct block *block = build_top(b);
    b->space = false;
    if (block && !at_start(block))
        put(b, "\n", 1);
}

void build_mark(struct builder *b, enum mark_kind kind, const char *value) {
    struct block *block = build_top(b);
    if (!block)
        return;
    if (b->space && !at_start(block))
        put(b, " ", 1);
    b->space = false;
    block = build_top(b);
    bool point = kind == MARK_NOTE || kind == MARK_PAGE;
    block->marks = mem_grow(block->marks, &block->mark_cap, block->mark_count + 1, sizeof *block->marks);
    block->marks[block->mark_count++] = (struct block_mark){
        kind, block->text.size, point ? block->text.size : (size_t)-1, value ? mem_strdup(value) : NULL};
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
    if (block->text.size > BLOCK_BYTES_MAX / 2) {
        build_block(b, BLOCK_VERSE);
        block = build_top(b);
    }
    if (block->line_count && block->lines[block->line_count - 1].start == block->text.size)
        free(block->lines[--block->line_count].n); /* it stayed empty */
    else if (block->text.size)
        put(b, "\n", 1);
    block->lines = mem_grow(block->lines, &block->line_cap, block->line_count + 1, sizeof *block->lines);
    block->lines[block->line_count++] =
        (struct block_line){block->text.size, block->text.size, n ? mem_strdup(n) : NULL, indent};
}

void build_line_end(struct builder *b) {
    struct block *block = build_top(b);
    b->space = false;
    if (block && block->line_count)
        block->lines[block->line_count - 1].end = block->text.size;
}

void build_inset(struct builder *b, enum block_kind kind, const char *n) {
    if (b->depth == NOTE_DEPTH_MAX)
        build_end(b);
    bool waits = b->space;
    struct block *host = build_top(b), *block = open_block(b, kind);
    block->n = n ? mem_strdup(n) : NULL;
    b->space = waits;
    if (host && kind == BLOCK_NOTE) {
        host->marks = mem_grow(host->marks, &host->mark_cap, host->mark_count + 1, sizeof *host->marks);
        host->marks[host->mark_count++] =
            (struct block_mark){MARK_NOTE, host->text.size, host->text.size, mem_strdup(block->name)};
    }
}

void build_inset_end(struct builder *b) {
    bool waits = b->space;
    build_end(b);
    b->space = waits && b->depth;
}

void build_page(struct builder *b, const char *n) {
    if (b->depth) {
        build_mark(b, MARK_PAGE, n ? n : "");
        return;
    }
    struct block *page = open_block(b, BLOCK_PAGE);
    page->n = mem_strdup(n ? n : "");
    build_end(b);
}

void build_speaker(struct builder *b, const char *name) {
    free(b->speaker);
    b->speaker = name && *name ? mem_strdup(name) : NULL;
}

void build_problem(struct builder *b, const struct error *e, bool serious) {
    if (b->told++ < PROBLEMS_MAX)
        b->sink->problem(b->sink->ctx, e, serious);
}
