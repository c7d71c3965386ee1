/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voice's part of the expressions. */
#include "server/base/mem.h"
#include "server/base/near.h"
#include "server/expression/recipe.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* However many cues lie over each other, a voice stays one that can be understood. */
static const struct voice_factors lowest = {0.6, 0.6, 0.3, 0.4}, highest = {1.6, 1.7, 2.5, 1.8};

struct part {
    struct voice_factors voice;
    struct score_emotion emotion;
    bool changes;
};

static double factor(double at_full, double intensity) {
    return 1 + (at_full - 1) * intensity;
}

static void apply(const struct expression *x, const struct score_cue *cue, struct part *part) {
    double i = fmin(1, fmax(0, cue->intensity));
    part->voice.rate *= factor(x->voice.rate, i);
    part->voice.pitch *= factor(x->voice.pitch, i);
    part->voice.range *= factor(x->voice.range, i);
    part->voice.volume *= factor(x->voice.volume, i);
    part->changes = true;
    if (!strcmp(x->kind, "affect")) /* the innermost comes last */
        part->emotion = (struct score_emotion){x->name, i};
}

static double bounded(double value, double min, double max) {
    return fmin(max, fmax(min, value));
}

static void style_item(struct score *score, struct score_item *item, const struct part *part) {
    struct score_style style = *item->style;
    style.rate *= bounded(part->voice.rate, lowest.rate, highest.rate);
    style.pitch *= bounded(part->voice.pitch, lowest.pitch, highest.pitch);
    style.range *= bounded(part->voice.range, lowest.range, highest.range);
    style.volume *= bounded(part->voice.volume, lowest.volume, highest.volume);
    if (part->emotion.name) {
        const char *name = part->emotion.name;
        style.emotion =
            (struct score_emotion){score_strndup(score, name, strlen(name)), part->emotion.intensity};
    }
    item->style = score_keep_style(score, &style);
}

void expressions_direct(const struct expressions *expressions, struct score *score) {
    struct part *parts = mem_alloc((score->item_count + 1) * sizeof *parts);
    for (size_t i = 0; i < score->item_count; i++)
        parts[i].voice = (struct voice_factors){1, 1, 1, 1};
    size_t kept = 0;
    for (size_t c = 0; c < score->cue_count; c++) {
        const struct score_cue *cue = &score->cues[c];
        int found = expressions_find(expressions, cue->kind, cue->name);
        if (found < 0) {
            struct near near = expressions_near(expressions, cue->kind, cue->name);
            char text[NEAR_TEXT];
            score_warn(score, cue->at, "unknown-expression", "no %s '%.80s': not shown%s", cue->kind,
                       cue->name, near_text(&near, text));
            continue;
        }
        for (size_t i = cue->first; i < cue->last && i < score->item_count; i++)
            apply(expressions_at(expressions, (size_t)found), cue, &parts[i]);
        score->cues[kept++] = *cue;
    }
    score->cue_count = kept;
    for (size_t i = 0; i < score->item_count; i++)
        if (parts[i].changes)
            style_item(score, &score->items[i], &parts[i]);
    free(parts);
}
