/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes the items of a score: appends the next piece of a text, and cuts items in parts. */
#include "server/base/mem.h"
#include "server/markup/score.h"
#include <stdlib.h>
#include <string.h>

static const char *keep(struct score *to, const char *s) {
    return s ? score_strndup(to, s, strlen(s)) : NULL;
}

static const struct score_style *keep_style(struct score *to, const struct score_style *style) {
    if (style == &score_plain_style)
        return style;
    struct score_style copy = *style;
    copy.lang = keep(to, style->lang);
    copy.voice = keep(to, style->voice);
    copy.gender = keep(to, style->gender);
    copy.say_as = keep(to, style->say_as);
    copy.phonemes = keep(to, style->phonemes);
    copy.lexicons = keep(to, style->lexicons);
    copy.emotion.name = keep(to, style->emotion.name);
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
        copy->text = keep(to, item->text);
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
        cue.name = keep(to, cue.name);
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
