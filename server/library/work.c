/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/work.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <stdlib.h>
#include <string.h>

void work_meta_free(struct work_meta *m) {
    char *const texts[] = {m->title, m->author, m->lang, m->date, m->publisher, m->licence, m->source};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        free(texts[i]);
    *m = (struct work_meta){0};
}

void work_meta_set(char **field, const char *text) {
    if (!*field && text && *text)
        *field = mem_strdup(text);
}

void block_spoken(const struct block *block, struct buf *out) {
    size_t from = out->size;
    buf_add(out, block->text.data, block->text.size);
    for (size_t i = 0; i < block->mark_count; i++) {
        const struct block_mark *m = &block->marks[i];
        if (m->kind == MARK_STAGE && m->start < m->end && m->end <= block->text.size)
            utf8_blank((char *)out->data + from + m->start, m->end - m->start);
    }
}

void block_free(struct block *b) {
    for (size_t i = 0; i < b->mark_count; i++)
        free(b->marks[i].value);
    for (size_t i = 0; i < b->line_count; i++)
        free(b->lines[i].n);
    free(b->marks);
    free(b->lines);
    free(b->lang);
    free(b->speaker);
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
