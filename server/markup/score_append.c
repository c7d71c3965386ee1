/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Appends the score of a text's next piece. */
#include "server/base/mem.h"
#include "server/markup/score.h"
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
