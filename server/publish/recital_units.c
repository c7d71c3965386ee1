/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/publish/recital_units.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

static void add_language(struct recital_places *p, const struct block *block, const struct block_mark *m) {
    size_t start = p->joined.size - block->text.size;
    if (m->kind != MARK_FOREIGN || !m->value || m->start >= m->end || m->end > block->text.size)
        return;
    size_t from = utf16_offset(&p->units, (char *)p->joined.data, start + m->start);
    buf_printf(&p->languages, "%s%zu-%zu:%s", p->languages.size ? " " : "", from,
               utf16_offset(&p->units, (char *)p->joined.data, start + m->end), m->value);
}

void recital_places_add(struct recital_places *p, const struct block *block, size_t number) {
    if (p->count)
        buf_add(&p->joined, "\n\n", 2);
    p->blocks = mem_grow(p->blocks, &p->cap, p->count + 1, sizeof *p->blocks);
    p->numbers = mem_grow(p->numbers, &p->numbers_cap, p->count + 1, sizeof *p->numbers);
    p->starts = mem_grow(p->starts, &p->starts_cap, p->count + 1, sizeof *p->starts);
    p->blocks[p->count] = block;
    p->numbers[p->count] = number;
    p->starts[p->count++] = p->joined.size;
    if (block->source)
        buf_add(&p->joined, block->source, strlen(block->source));
    else
        block_spoken(block, &p->joined);
    for (size_t i = 0; i < block->mark_count && !block->source; i++)
        add_language(p, block, &block->marks[i]);
}

void recital_places_end(struct recital_places *p) {
    buf_add(&p->joined, "", 1);
    p->text = (const char *)p->joined.data;
}

void recital_places_free(struct recital_places *p) {
    free(p->blocks);
    free(p->numbers);
    free(p->starts);
    buf_free(&p->joined);
    buf_free(&p->languages);
    *p = (struct recital_places){0};
}

/* The block that the byte of the text lies in. */
static size_t block_at(const struct recital_places *p, size_t byte) {
    size_t low = 0, high = p->count;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (p->starts[middle] <= byte)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* A block in markup shows a space for each unit of its tags: source and text agree in UTF-16 units. Places
 * mostly rise. */
static size_t shown_at(struct recital_places *p, size_t byte) {
    const struct buf *text = &p->blocks[0]->text;
    size_t units = utf16_offset(&p->source, p->text, byte);
    if (units < p->at_units)
        p->at = p->at_units = 0;
    while (p->at_units < units && p->at < text->size) {
        uint32_t cp;
        size_t n = utf8_next((const char *)text->data + p->at, text->size - p->at, &cp);
        p->at += n ? n : 1;
        p->at_units += n == 4 ? 2 : 1;
    }
    return p->at;
}

static size_t place(struct recital_places *p, size_t block, size_t byte) {
    size_t size = p->blocks[block]->text.size;
    size_t at = p->blocks[block]->source ? shown_at(p, byte) : byte - p->starts[block];
    return at < size ? at : size;
}

/* What overlaps the one before is one with it: "1998" is one word here, and several to the voice. */
static void add(struct recital_part *part, size_t block, size_t from, size_t to, uint64_t start) {
    const struct recital_unit *last = part->count ? &part->units[part->count - 1] : NULL;
    if (to <= from || (last && last->block == block && from < last->to) || (last && block < last->block))
        return;
    if (last && start < last->start)
        start = last->start;
    part->units = mem_grow(part->units, &part->cap, part->count + 1, sizeof *part->units);
    part->units[part->count++] = (struct recital_unit){block, from, to, start};
}

/* The end of the line of verse that the byte lies in; SIZE_MAX: there are no lines. */
static size_t line_end(const struct block *b, size_t byte) {
    for (size_t i = 0; i < b->line_count; i++)
        if (byte < b->lines[i].end)
            return b->lines[i].end;
    return SIZE_MAX;
}

void recital_units_add(struct recital_places *p, struct recital_part *part,
                       const struct sentence_audio *audio, uint64_t start, bool sentences) {
    size_t until = 0, unit_from = 0, unit_to = 0, unit_block = SIZE_MAX;
    uint64_t unit_start = 0;
    for (size_t i = 0; i < audio->word_count; i++) {
        const struct word *w = &audio->words[i];
        size_t block = block_at(p, w->from);
        size_t from = place(p, block, w->from), to = place(p, block, w->to);
        if (!sentences) {
            add(part, p->numbers[block], from, to, start + w->start);
            continue;
        }
        if (block != unit_block || from >= until) {
            if (unit_block != SIZE_MAX)
                add(part, p->numbers[unit_block], unit_from, unit_to, unit_start);
            unit_block = block;
            unit_from = from;
            unit_start = start + w->start;
            until = line_end(p->blocks[block], from);
        }
        unit_to = to;
    }
    if (sentences && unit_block != SIZE_MAX) {
        size_t end = audio->to > p->starts[unit_block] ? place(p, unit_block, audio->to) : 0;
        unit_to = end > unit_to && end <= until ? end : unit_to; /* with its full stop */
        add(part, p->numbers[unit_block], unit_from, unit_to, unit_start);
    }
}
