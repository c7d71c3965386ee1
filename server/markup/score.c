/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/score.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void score_quality_add(struct score_quality *quality, const struct score_quality *more, double share) {
    quality->tilt = fmax(-QUALITY_TILT_MAX, fmin(QUALITY_TILT_MAX, quality->tilt + share * more->tilt));
    quality->aspiration = fmin(1, quality->aspiration + share * more->aspiration);
    quality->jitter = fmin(QUALITY_JITTER_MAX, quality->jitter + share * more->jitter);
    quality->shimmer = fmin(QUALITY_SHIMMER_MAX, quality->shimmer + share * more->shimmer);
    quality->flutter = fmin(QUALITY_FLUTTER_MAX, quality->flutter + share * more->flutter);
    quality->tremor = fmin(QUALITY_TREMOR_MAX, quality->tremor + share * more->tremor);
}

bool score_quality_equal(const struct score_quality *a, const struct score_quality *b) {
    return a->tilt == b->tilt && a->aspiration == b->aspiration && a->jitter == b->jitter &&
           a->shimmer == b->shimmer && a->flutter == b->flutter && a->tremor == b->tremor;
}

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
        strcpy(message, "more is ignored");
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
                           "the pauses of %s may last %d s in total: the rest is dropped",
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

/* Changes the items of a score: appends the next piece of a text, and cuts items in parts. */

static const char *keep_text(struct score *to, const char *s) {
    return s ? score_strndup(to, s, strlen(s)) : NULL;
}

static const struct score_style *keep_style(struct score *to, const struct score_style *style) {
    if (style == &score_plain_style)
        return style;
    struct score_style copy = *style;
    copy.lang = keep_text(to, style->lang);
    copy.voice = keep_text(to, style->voice);
    copy.gender = keep_text(to, style->gender);
    copy.say_as = keep_text(to, style->say_as);
    copy.phonemes = keep_text(to, style->phonemes);
    copy.lexicons = keep_text(to, style->lexicons);
    copy.emotion.name = keep_text(to, style->emotion.name);
    return score_keep_style(to, &copy);
}

static void keep_parts(struct score *to, struct score_item *copy, const struct score_item *item,
                       size_t (*place)(const void *, size_t), const void *ctx) {
    struct score_part *parts = (struct score_part *)score_keep_parts(to, item->parts, item->part_count);
    for (size_t i = 0; i < item->part_count; i++) {
        parts[i].start = place(ctx, parts[i].start);
        parts[i].end = place(ctx, parts[i].end);
    }
    copy->parts = parts;
    copy->part_count = item->part_count;
}

static void add_items(struct score *to, const struct score *from, size_t (*place)(const void *, size_t),
                      const void *ctx) {
    const struct score_style *last = NULL, *kept = NULL;
    for (size_t i = 0; i < from->item_count; i++) {
        const struct score_item *item = &from->items[i];
        struct score_item *copy = score_add(to, item->kind, place(ctx, item->start), place(ctx, item->end));
        kept = item->style == last ? kept : keep_style(to, item->style);
        last = item->style;
        copy->text = keep_text(to, item->text);
        copy->verbatim = item->verbatim;
        copy->given = item->given;
        keep_parts(to, copy, item, place, ctx);
        copy->seconds = item->seconds;
        copy->fallback = item->fallback;
        copy->style = kept;
    }
}

void score_append(struct score *to, const struct score *from, size_t (*place)(const void *, size_t),
                  const void *ctx) {
    size_t items = to->item_count, cues = to->cue_count;
    add_items(to, from, place, ctx);
    for (size_t i = 0; i < from->sentence_count; i++) {
        struct score_sentence s = from->sentences[i];
        to->sentences =
            mem_grow(to->sentences, &to->sentence_cap, to->sentence_count + 1, sizeof *to->sentences);
        to->sentences[to->sentence_count++] = (struct score_sentence){
            s.first + items, s.count, place(ctx, s.start), place(ctx, s.end), s.in_words};
    }
    for (size_t i = 0; i < from->cue_count; i++) {
        struct score_cue cue = from->cues[i];
        cue.name = keep_text(to, cue.name);
        cue.first += items;
        cue.last += items;
        cue.around += cue.around ? cues : 0;
        cue.at = place(ctx, cue.at);
        to->cues = mem_grow(to->cues, &to->cue_cap, to->cue_count + 1, sizeof *to->cues);
        to->cues[to->cue_count++] = cue;
    }
}

/* Adds the part [from, to) of an item's text. */
static void add_part(struct score *script, const struct score_item *item, size_t from, size_t to) {
    struct score_item *part = score_add(script, item->kind, item->start, item->end);
    *part = *item;
    part->text = score_strndup(script, item->text + from, to - from);
    if (item->verbatim) {
        part->start = item->start + from;
        part->end = item->start + to;
    }
}

size_t *score_cut(struct score *script, const struct score_cut *cuts, size_t count) {
    size_t old = script->item_count, cut = 0;
    struct score_item *items = script->items;
    size_t *now = mem_alloc((old + 1) * sizeof *now), *origin = mem_alloc((old + count + 1) * sizeof *origin);
    script->items = NULL;
    script->item_count = script->item_cap = 0;
    for (size_t i = 0; i < old; i++) {
        now[i] = script->item_count;
        size_t from = 0;
        for (; cut < count && cuts[cut].item == i; cut++) {
            add_part(script, &items[i], from, cuts[cut].at);
            from = cuts[cut].at;
        }
        if (from)
            add_part(script, &items[i], from, strlen(items[i].text));
        else
            *score_add(script, items[i].kind, items[i].start, items[i].end) = items[i];
        for (size_t k = now[i]; k < script->item_count; k++)
            origin[k] = i;
    }
    now[old] = script->item_count;
    for (size_t i = 0; i < old; i++)
        if (items[i].kind == SCORE_AUDIO)
            script->items[now[i]].fallback = now[i + 1 + items[i].fallback] - now[i + 1];
    for (size_t i = 0; i < script->sentence_count; i++) {
        struct score_sentence *s = &script->sentences[i];
        size_t end = now[s->first + s->count];
        s->first = now[s->first];
        s->count = end - s->first;
    }
    for (size_t i = 0; i < script->cue_count; i++) {
        script->cues[i].first = now[script->cues[i].first];
        script->cues[i].last = now[script->cues[i].last];
    }
    free(items);
    free(now);
    return origin;
}

/* Sorts a score's cues, limits how many overlap, and finds those of a sentence. */

/* By beginning, outer ones first. */
static int compare_cues(const void *a, const void *b) {
    const struct score_cue *x = a, *y = b;
    if (x->first != y->first)
        return x->first < y->first ? -1 : 1;
    if (x->at != y->at)
        return x->at < y->at ? -1 : 1;
    int kind = strcmp(x->kind, y->kind);
    return kind ? kind : strcmp(x->name, y->name);
}

static int compare_clocks(const void *a, const void *b) {
    const struct score_cue *x = a, *y = b;
    if (x->clock != y->clock)
        return x->clock < y->clock ? -1 : 1;
    return (x->at > y->at) - (x->at < y->at);
}

static void sort_cues(struct score *score) {
    size_t in_order = 1;
    while (in_order < score->cue_count &&
           compare_cues(&score->cues[in_order - 1], &score->cues[in_order]) <= 0)
        in_order++;
    if (in_order < score->cue_count)
        qsort(score->cues, score->cue_count, sizeof *score->cues, compare_cues);
}

static bool is_in_or_behind(const struct score *score, size_t sentence, size_t item) {
    return sentence < score->sentence_count && score->sentences[sentence].first <= item;
}

/* Sentence of an item, at or after sentence `from`; the last sentence if the item lies beyond it. */
static size_t sentence_of(const struct score *score, size_t from, size_t item) {
    if (!is_in_or_behind(score, from + 1, item))
        return from;
    size_t low = from + 1, high = score->sentence_count;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (score->sentences[middle].first <= item)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Each sentence costs time in proportion to its cues, and one cue may span many sentences. */
static void limit_cues(struct score *score) {
    size_t *ended = mem_alloc((score->sentence_count + 1) * sizeof *ended), active = 0, sentence = 0,
           kept = 0;
    for (size_t i = 0; i < score->cue_count; i++) {
        struct score_cue *cue = &score->cues[i];
        while (is_in_or_behind(score, sentence + 1, cue->first))
            active -= ended[sentence++];
        if (active == SCORE_CUES) {
            score_warn(score, cue->at, ERROR_IGNORED, "more than %d behaviours at once: this one is dropped",
                       SCORE_CUES);
            continue;
        }
        active++;
        ended[cue->last > cue->first ? sentence_of(score, sentence, cue->last - 1) : sentence]++;
        if (kept != i)
            score->cues[kept] = *cue;
        kept++;
    }
    score->cue_count = kept;
    free(ended);
}

void score_link_cues(struct score *score) {
    for (size_t i = 0; i < score->cue_count; i++) {
        size_t around = i;
        while (around && score->cues[around - 1].last <= score->cues[i].last)
            around = score->cues[around - 1].around;
        score->cues[i].around = around;
    }
}

void score_order_cues(struct score *score) {
    sort_cues(score);
    if (score->timed_count)
        qsort(score->timed, score->timed_count, sizeof *score->timed, compare_clocks);
    if (score->sentence_count)
        limit_cues(score);
    score_link_cues(score);
}

size_t score_cues_from(const struct score *score, size_t item) {
    size_t low = 0, high = score->cue_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (score->cues[middle].first < item)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}
