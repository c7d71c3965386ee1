/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/plan.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool same(const char *a, const char *b) {
    return a == b || (a && b && !strcmp(a, b));
}

/* Would the two styles make the same span? A stretch to be read in its own way, or from given phones, stands
 * alone. */
static bool joins(const struct score_style *a, const struct score_style *b,
                  const struct plan_prosody *prosody) {
    if (a->say_as || b->say_as || a->phonemes || b->phonemes)
        return false;
    return a == b || (same(a->lang, b->lang) && same(a->voice, b->voice) && a->rate == b->rate &&
                      a->pitch == b->pitch && a->range == b->range && a->volume == b->volume &&
                      a->emphasis == b->emphasis &&
                      (!prosody->plays || (same(a->emotion.name, b->emotion.name) &&
                                           a->emotion.intensity == b->emotion.intensity)));
}

static char *copy(const char *s) {
    return s ? mem_strdup(s) : NULL;
}

static struct faccia_span *add_span(struct plan *plan, uint32_t kind) {
    plan->spans = mem_grow(plan->spans, &plan->span_cap, plan->span_count + 1, sizeof *plan->spans);
    struct faccia_span *span = &plan->spans[plan->span_count++];
    *span = (struct faccia_span){.kind = kind, .pitch = 1, .range = 1, .volume = 1};
    return span;
}

static void begin_text(struct plan *plan, const struct score_style *style,
                       const struct plan_prosody *prosody) {
    struct faccia_span *span = add_span(plan, FACCIA_SPAN_TEXT);
    plan->last_bytes = plan->last_cap = 0;
    span->lang = prosody->chosen ? NULL : copy(style->lang);
    span->phones = copy(style->phonemes);
    span->say_as = copy(style->say_as);
    span->emotion = prosody->plays ? copy(style->emotion.name) : NULL;
    span->intensity = span->emotion ? style->emotion.intensity : 0;
    span->rate = prosody->rate;
    if (style->rate != 1)
        span->rate = (prosody->rate > 0 ? prosody->rate : prosody->own_rate) * style->rate;
    span->pitch = prosody->pitch * style->pitch;
    span->range = style->range;
    span->volume = prosody->volume * style->volume;
    span->emphasis = (uint32_t)style->emphasis;
}

static void add_text(struct plan *plan, const struct score_item *item) {
    struct faccia_span *span = &plan->spans[plan->span_count - 1];
    size_t before = plan->last_bytes, bytes = strlen(item->text);
    char *text = mem_grow((char *)span->text, &plan->last_cap, before + bytes + 1, 1);
    memcpy(text + before, item->text, bytes + 1);
    span->text = text;
    plan->last_bytes += bytes;
    plan->text_bytes += bytes;
    const struct score_part whole = {0, bytes, item->start, item->end, item->verbatim, false};
    const struct score_part *parts = item->parts ? item->parts : &whole;
    size_t count = item->parts ? item->part_count : 1;
    plan->pieces = mem_grow(plan->pieces, &plan->piece_cap, plan->piece_count + count, sizeof *plan->pieces);
    for (size_t i = 0; i < count; i++)
        plan->pieces[plan->piece_count++] = (struct plan_piece){
            .span = (uint32_t)(plan->span_count - 1),
            .offset = before + parts[i].offset,
            .bytes = parts[i].bytes,
            .from = parts[i].start,
            .to = parts[i].end,
            .verbatim = parts[i].verbatim,
        };
}

/* What of the cue lies in the sentence, if anything. A point is where the item that follows it is; one at the
 * very end belongs to the last sentence. */
static void add_cue(struct plan *plan, const struct score *score, const struct score_sentence *s,
                    const struct score_cue *cue) {
    size_t end = s->first + s->count, first = cue->first, last = cue->last;
    bool at_the_end = first == score->item_count && end == score->item_count;
    bool point = first == last;
    if (point ? (first < s->first || first >= end) && !at_the_end : last <= s->first || first >= end)
        return;
    struct plan_cue mine = {.intensity = cue->intensity,
                            .weight = cue->weight,
                            .onset = cue->onset,
                            .offset = cue->offset,
                            .delay = cue->delay,
                            .duration = cue->duration,
                            .began_before = first<s->first, .goes_on = last> end};
    first = first < s->first ? s->first : first;
    last = last > end ? end : last;
    mine.from = first < end ? score->items[first].start : s->end;
    mine.to = point ? mine.from : score->items[last - 1].end;
    mine.kind = mem_strdup(cue->kind);
    mine.name = mem_strdup(cue->name);
    plan->cues = mem_grow(plan->cues, &plan->cue_cap, plan->cue_count + 1, sizeof *plan->cues);
    plan->cues[plan->cue_count++] = mine;
}

static void turn_round(struct plan_cue *cues, size_t count) {
    for (size_t i = 0; i < count / 2; i++) {
        struct plan_cue cue = cues[i];
        cues[i] = cues[count - 1 - i];
        cues[count - 1 - i] = cue;
    }
}

void plan_cues(struct plan *plan, const struct score *score, size_t sentence) {
    const struct score_sentence *s = &score->sentences[sentence];
    size_t own = score_cues_from(score, s->first), end = s->first + s->count;
    *plan = (struct plan){.from = s->start, .to = s->end};
    /* those that began before and go on: from the last one outwards */
    for (size_t i = own; i;)
        if (score->cues[i - 1].last > s->first)
            add_cue(plan, score, s, &score->cues[--i]);
        else
            i = score->cues[i - 1].around;
    turn_round(plan->cues, plan->cue_count);
    for (size_t i = own; i < score->cue_count; i++) {
        if (score->cues[i].first >= end && end < score->item_count)
            break;
        add_cue(plan, score, s, &score->cues[i]);
    }
}

static void add_items(struct plan *plan, const struct score *score, size_t first, size_t count,
                      const struct plan_prosody *prosody) {
    const struct score_style *style = NULL; /* of the text span that is still open */
    for (size_t i = first; i < first + count; i++) {
        const struct score_item *item = &score->items[i];
        if (item->kind == SCORE_TEXT) {
            if (!item->text || !*item->text)
                continue;
            if (!style || !joins(style, item->style, prosody))
                begin_text(plan, item->style, prosody);
            style = item->style;
            add_text(plan, item);
            continue;
        }
        style = NULL;
        if (item->kind == SCORE_MARK) {
            add_span(plan, FACCIA_SPAN_MARK)->text = mem_strdup(item->text ? item->text : "");
        } else if (item->kind == SCORE_BREAK) {
            double seconds = isfinite(item->seconds) && item->seconds > 0 ? item->seconds : 0;
            add_span(plan, FACCIA_SPAN_BREAK)->seconds = seconds;
            plan->break_seconds += seconds;
        }
    }
}

void plan_make(struct plan *plan, const struct score *score, size_t sentence,
               const struct plan_prosody *prosody) {
    const struct score_sentence *s = &score->sentences[sentence];
    plan_cues(plan, score, sentence);
    add_items(plan, score, s->first, s->count, prosody);
}

void plan_items(struct plan *plan, const struct score *score, size_t first, size_t count,
                const struct plan_prosody *prosody) {
    *plan = (struct plan){0};
    if (count) {
        plan->from = score->items[first].start;
        plan->to = score->items[first + count - 1].end;
    }
    add_items(plan, score, first, count, prosody);
}

struct faccia_sentence plan_sentence(const struct plan *plan, const char *voice) {
    return (struct faccia_sentence){.voice = voice,
                                    .spans = plan->spans,
                                    .span_count = plan->span_count,
                                    .before = plan->before,
                                    .after = plan->after};
}

void plan_go_on(struct plan *plan) {
    struct faccia_span *last = NULL;
    for (size_t i = 0; i < plan->span_count; i++)
        if (plan->spans[i].kind == FACCIA_SPAN_TEXT)
            last = &plan->spans[i];
    if (!last || last->say_as || last->phones)
        return;
    size_t length = strlen(last->text), end = length;
    while (end && isspace((unsigned char)last->text[end - 1]))
        end--;
    if (!end || ispunct((unsigned char)last->text[end - 1]))
        return;
    char *text = mem_resize((char *)last->text, length + 2);
    memmove(text + end + 1, text + end, length - end + 1);
    text[end] = ',';
    last->text = text;
    plan->text_bytes++;
}

void plan_free(struct plan *plan) {
    for (size_t i = 0; i < plan->span_count; i++) {
        struct faccia_span *span = &plan->spans[i];
        free((char *)span->text);
        free((char *)span->lang);
        free((char *)span->phones);
        free((char *)span->say_as);
        free((char *)span->emotion);
    }
    for (size_t i = 0; i < plan->cue_count; i++) {
        free((char *)plan->cues[i].kind);
        free((char *)plan->cues[i].name);
    }
    free(plan->before);
    free(plan->after);
    free(plan->cues);
    free(plan->spans);
    free(plan->pieces);
    *plan = (struct plan){0};
}

static bool inside_character(const char *text, size_t at) {
    return ((unsigned char)text[at] & 0xC0) == 0x80;
}

/* Cuts off what lies outside the span's text and moves both ends outwards to whole characters. False when
 * nothing is left. */
static bool clip(const struct plan *plan, uint32_t span, size_t *offset, size_t bytes, size_t *end) {
    if (span >= plan->span_count || plan->spans[span].kind != FACCIA_SPAN_TEXT)
        return false;
    const char *text = plan->spans[span].text;
    size_t length = strlen(text);
    if (*offset >= length || !bytes)
        return false;
    *end = bytes < length - *offset ? *offset + bytes : length;
    while (*offset > 0 && inside_character(text, *offset))
        --*offset;
    while (*end < length && inside_character(text, *end))
        ++*end;
    return true;
}

char *plan_text(const struct plan *plan, uint32_t span, size_t offset, size_t bytes) {
    size_t end;
    return clip(plan, span, &offset, bytes, &end) ? mem_strndup(plan->spans[span].text + offset, end - offset)
                                                  : mem_strdup("");
}

bool plan_locate(const struct plan *plan, uint32_t span, size_t offset, size_t bytes, size_t *from,
                 size_t *to) {
    size_t end;
    if (!clip(plan, span, &offset, bytes, &end))
        return false;
    bool found = false;
    for (size_t i = 0; i < plan->piece_count; i++) {
        const struct plan_piece *p = &plan->pieces[i];
        if (p->span != span || p->offset + p->bytes <= offset || p->offset >= end)
            continue;
        if (!found)
            *from = p->verbatim && offset > p->offset ? p->from + (offset - p->offset) : p->from;
        *to = p->verbatim && end < p->offset + p->bytes ? p->from + (end - p->offset) : p->to;
        found = true;
    }
    return found;
}
