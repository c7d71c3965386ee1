/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts a score's cues, limits how many overlap, and finds those of a sentence. */
#include "server/base/mem.h"
#include "server/markup/score.h"
#include <stdlib.h>
#include <string.h>

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
            score_warn(score, cue->at, ERROR_IGNORED, "more than %d things at once: this is left out",
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
