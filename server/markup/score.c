/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/score.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

const struct score_style score_plain_style = {.rate = 1, .pitch = 1, .range = 1, .volume = 1};

/* Memory that is only ever freed as a whole: strings and styles of one score. */
struct score_block {
    struct score_block *next;
    size_t used, size;
    _Alignas(max_align_t) char data[];
};

static void *keep(struct score *score, size_t size) {
    size = (size + _Alignof(max_align_t) - 1) & ~(_Alignof(max_align_t) - 1);
    struct score_block *block = score->blocks;
    if (!block || block->size - block->used < size) {
        size_t room = size > 4096 ? size : 4096;
        block = mem_alloc(sizeof *block + room);
        block->size = room;
        block->next = score->blocks;
        score->blocks = block;
    }
    void *p = block->data + block->used;
    block->used += size;
    return p;
}

struct score *score_new(void) {
    return mem_alloc(sizeof(struct score));
}

void score_free(struct score *score) {
    if (!score)
        return;
    for (struct score_block *block = score->blocks, *next; block; block = next) {
        next = block->next;
        free(block);
    }
    free(score->items);
    free(score->sentences);
    free(score->warnings);
    free(score);
}

const char *score_strndup(struct score *score, const char *s, size_t n) {
    char *copy = keep(score, n + 1);
    memcpy(copy, s, n);
    copy[n] = '\0';
    return copy;
}

const struct score_style *score_keep_style(struct score *score, const struct score_style *style) {
    struct score_style *copy = keep(score, sizeof *copy);
    *copy = *style;
    return copy;
}

struct score_item *score_add(struct score *score, enum score_kind kind, size_t start, size_t end) {
    score->items = mem_grow(score->items, &score->item_cap, score->item_count + 1, sizeof *score->items);
    struct score_item *item = &score->items[score->item_count++];
    *item = (struct score_item){.kind = kind, .start = start, .end = end, .style = &score_plain_style};
    return item;
}

void score_end_sentence(struct score *score) {
    size_t first = 0;
    if (score->sentence_count) {
        const struct score_sentence *last = &score->sentences[score->sentence_count - 1];
        first = last->first + last->count;
    }
    if (first == score->item_count)
        return;
    score->sentences =
        mem_grow(score->sentences, &score->sentence_cap, score->sentence_count + 1, sizeof *score->sentences);
    score->sentences[score->sentence_count++] = (struct score_sentence){
        .first = first,
        .count = score->item_count - first,
        .start = score->items[first].start,
        .end = score->items[score->item_count - 1].end,
    };
}
