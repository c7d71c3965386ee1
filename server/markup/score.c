/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/score.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct score_style score_plain_style = {.rate = 1, .pitch = 1, .range = 1, .volume = 1};

/* Arena for the strings and styles of a score, freed as a whole. */
struct score_block {
    struct score_block *next;
    size_t used, size;
    _Alignas(max_align_t) char data[];
};

enum { BLOCK_MIN = 4096, BLOCK_MAX = 1 << 18 };

static void *keep(struct score *score, size_t size) {
    size = (size + _Alignof(max_align_t) - 1) & ~(_Alignof(max_align_t) - 1);
    struct score_block *block = score->blocks;
    if (!block || block->size - block->used < size) {
        size_t room = block && block->size < BLOCK_MAX ? 2 * block->size : BLOCK_MIN;
        room = size > room ? size : room;
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
    free(score->cues);
    free(score->timed);
    free(score->warnings);
    free(score);
}

/* The capacity equals the count; mem_grow enlarges it later. */
static void *copy(const void *list, size_t count, size_t size) {
    return count ? memcpy(mem_resize(NULL, count * size), list, count * size) : NULL;
}

struct score *score_script(const struct score *document) {
    struct score *s = score_new();
    *s = *document;
    s->blocks = NULL;
    s->items = copy(s->items, s->item_cap = s->item_count, sizeof *s->items);
    s->sentences = copy(s->sentences, s->sentence_cap = s->sentence_count, sizeof *s->sentences);
    s->cues = copy(s->cues, s->cue_cap = s->cue_count, sizeof *s->cues);
    s->timed = copy(s->timed, s->timed_cap = s->timed_count, sizeof *s->timed);
    s->warnings = copy(s->warnings, s->warning_cap = s->warning_count, sizeof *s->warnings);
    return s;
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

const struct score_part *score_keep_parts(struct score *score, const struct score_part *parts, size_t count) {
    return count ? memcpy(keep(score, count * sizeof *parts), parts, count * sizeof *parts) : NULL;
}

struct score_item *score_add(struct score *score, enum score_kind kind, size_t start, size_t end) {
    score->items = mem_grow(score->items, &score->item_cap, score->item_count + 1, sizeof *score->items);
    struct score_item *item = &score->items[score->item_count++];
    *item = (struct score_item){.kind = kind, .start = start, .end = end, .style = &score_plain_style};
    return item;
}

static struct score_cue new_cue(struct score *score, const char *kind, const char *name, size_t at) {
    return (struct score_cue){
        .kind = kind,
        .name = score_strndup(score, name, strlen(name)),
        .first = score->item_count,
        .last = score->item_count,
        .at = at,
        .intensity = 1,
        .weight = -1,
        .duration = {.share = 1},
        .onset = -1,
        .offset = -1,
    };
}

struct score_cue *score_add_cue(struct score *score, const char *kind, const char *name, size_t at) {
    score->cues = mem_grow(score->cues, &score->cue_cap, score->cue_count + 1, sizeof *score->cues);
    struct score_cue *cue = &score->cues[score->cue_count++];
    *cue = new_cue(score, kind, name, at);
    return cue;
}

struct score_cue *score_add_timed(struct score *score, const char *kind, const char *name, size_t at,
                                  double clock, double seconds) {
    if (score->timed_count == SCORE_TIMED)
        return NULL;
    score->timed = mem_grow(score->timed, &score->timed_cap, score->timed_count + 1, sizeof *score->timed);
    struct score_cue *cue = &score->timed[score->timed_count++];
    *cue = new_cue(score, kind, name, at);
    cue->clock = clock;
    cue->duration = (struct score_time){.seconds = seconds};
    return cue;
}

void score_warn(struct score *score, size_t at, enum error_code code, const char *format, ...) {
    if (score->warning_count == SCORE_WARNINGS)
        return;
    score->warnings =
        mem_grow(score->warnings, &score->warning_cap, score->warning_count + 1, sizeof *score->warnings);
    struct error *warning = &score->warnings[score->warning_count++];
    char message[sizeof warning->message];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    utf8_mend(message);
    if (score->warning_count == SCORE_WARNINGS) {
        code = ERROR_MORE_WARNINGS;
        strcpy(message, "there is more that is not acted on");
    }
    if (!score->input) {
        error_at_byte(warning, code, at, "%s", message);
        return;
    }
    size_t line, column;
    lines_place(&score->lines, score->input, at < score->input_size ? at : score->input_size, &line, &column);
    error_at_line(warning, code, line, column, "%s", message);
}

double score_pauses(const struct score *score) {
    double seconds = 0;
    for (size_t i = 0; i < score->item_count; i++)
        if (score->items[i].kind == SCORE_BREAK)
            seconds += score->items[i].seconds;
    return seconds;
}

void score_bound_pauses(struct score *score, double paused) {
    for (size_t i = 0; i < score->sentence_count; i++) {
        const struct score_sentence *s = &score->sentences[i];
        double own = 0;
        bool told = false;
        for (size_t k = s->first; k < s->first + s->count; k++) {
            struct score_item *item = &score->items[k];
            if (item->kind != SCORE_BREAK)
                continue;
            double left = fmax(fmin(SCORE_PAUSE_SENTENCE - own, SCORE_PAUSE_TEXT - paused), 0);
            if (item->seconds > left && !told) {
                bool all = SCORE_PAUSE_TEXT - paused < SCORE_PAUSE_SENTENCE - own;
                score_warn(score, item->start, ERROR_BAD_VALUE,
                           "the pauses of %s may last %d s together: the rest is left out",
                           all ? "a text" : "a sentence", all ? SCORE_PAUSE_TEXT : SCORE_PAUSE_SENTENCE);
                told = true;
            }
            item->seconds = fmin(item->seconds, left);
            own += item->seconds;
            paused += item->seconds;
        }
    }
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
