/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Applies expressions to the voice. */
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Limits that keep a voice intelligible when cues overlap. */
static const struct voice_factors lowest = {.rate = 0.6, .pitch = 0.6, .range = 0.3, .volume = 0.4},
                                  highest = {.rate = 1.6, .pitch = 1.7, .range = 2.5, .volume = 1.8};

/* Effect of the cues over some items. */
struct voice_change {
    struct voice_factors voice;
    const char *emotion; /* of the innermost affect; NULL = none */
    double intensity;
    size_t order; /* of its cue, from 1; 0 = none */
    bool changes;
};

static double factor(double at_full, double intensity) {
    return 1 + (at_full - 1) * intensity;
}

static struct voice_change change_of(const struct expression *x, const struct score_cue *cue, size_t order) {
    double i = fmin(1, fmax(0, cue->intensity));
    bool is_affect = !strcmp(x->kind, "affect");
    struct voice_change change = {.voice = {.rate = factor(x->voice.rate, i),
                                            .pitch = factor(x->voice.pitch, i),
                                            .range = factor(x->voice.range, i),
                                            .volume = factor(x->voice.volume, i)},
                                  .emotion = is_affect ? x->name : NULL,
                                  .intensity = i,
                                  .order = is_affect ? order : 0,
                                  .changes = true};
    score_quality_add(&change.voice.quality, &x->voice.quality, i);
    return change;
}

static void apply(const struct voice_change *more, struct voice_change *change) {
    if (!more->changes)
        return;
    change->voice.rate *= more->voice.rate;
    change->voice.pitch *= more->voice.pitch;
    change->voice.range *= more->voice.range;
    change->voice.volume *= more->voice.volume;
    score_quality_add(&change->voice.quality, &more->voice.quality, 1);
    change->changes = true;
    if (more->order > change->order) {
        change->emotion = more->emotion;
        change->intensity = more->intensity;
        change->order = more->order;
    }
}

static double bounded(double value, double min, double max) {
    return fmin(max, fmax(min, value));
}

static void style_item(struct score *score, struct score_item *item, const struct voice_change *change) {
    struct score_style style = *item->style;
    style.rate *= bounded(change->voice.rate, lowest.rate, highest.rate);
    style.pitch *= bounded(change->voice.pitch, lowest.pitch, highest.pitch);
    style.range *= bounded(change->voice.range, lowest.range, highest.range);
    style.volume *= bounded(change->voice.volume, lowest.volume, highest.volume);
    score_quality_add(&style.quality, &change->voice.quality, 1);
    if (change->emotion)
        style.emotion = (struct score_emotion){score_strndup(score, change->emotion, strlen(change->emotion)),
                                               change->intensity};
    item->style = score_keep_style(score, &style);
}

/* A segment tree: a cue over many items is stored in the few nodes that cover them, so overlapping cues
 * cost only their number. Node i covers nodes 2i and 2i + 1; count + i is item i. */
static void apply_to_items(struct voice_change *tree, size_t count, size_t first, size_t last,
                           const struct voice_change *change) {
    for (size_t a = first + count, b = last + count; a < b; a /= 2, b /= 2) {
        if (a % 2)
            apply(change, &tree[a++]);
        if (b % 2)
            apply(change, &tree[--b]);
    }
}

static void hand_down(struct voice_change *tree, size_t count) {
    for (size_t i = 1; i < count; i++) {
        apply(&tree[i], &tree[2 * i]);
        apply(&tree[i], &tree[2 * i + 1]);
    }
}

/* Returns the index of the cue's entry, or -1 with a warning. */
static int find(const struct expressions *expressions, struct score *score, const struct score_cue *cue) {
    int found = expressions_find(expressions, cue->kind, cue->name);
    if (found < 0) {
        struct suggestions near = expressions_near(expressions, cue->kind, cue->name);
        char text[SUGGESTIONS_TEXT];
        score_warn(score, cue->at, ERROR_UNKNOWN_EXPRESSION, "unknown %s '%.80s': not shown%s", cue->kind,
                   cue->name, suggestions_text(&near, text));
    }
    return found;
}

void expressions_direct(const struct expressions *expressions, struct score *score) {
    size_t kept = 0, count = score->item_count;
    struct voice_change *tree = mem_alloc((2 * count + 1) * sizeof *tree);
    for (size_t i = 0; i < 2 * count; i++)
        tree[i].voice = (struct voice_factors){.rate = 1, .pitch = 1, .range = 1, .volume = 1};
    for (size_t c = 0; c < score->cue_count; c++) {
        const struct score_cue *cue = &score->cues[c];
        int found = find(expressions, score, cue);
        if (found < 0)
            continue;
        struct voice_change change = change_of(expressions_at(expressions, (size_t)found), cue, c + 1);
        if (cue->first < count)
            apply_to_items(tree, count, cue->first, cue->last < count ? cue->last : count, &change);
        score->cues[kept++] = *cue;
    }
    score->cue_count = kept;
    score_link_cues(score);
    kept = 0;
    for (size_t c = 0; c < score->timed_count; c++)
        if (find(expressions, score, &score->timed[c]) >= 0)
            score->timed[kept++] = score->timed[c];
    score->timed_count = kept;
    hand_down(tree, count);
    for (size_t i = 0; i < count; i++)
        if (tree[count + i].changes)
            style_item(score, &score->items[i], &tree[count + i]);
    free(tree);
}
