/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_request.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool same(const char *a, const char *b) {
    return a == b || (a && b && !strcmp(a, b));
}

/* Tells whether two styles can share a span. Text with say-as or given phones stands alone. */
static bool joins_span(const struct score_style *a, const struct score_style *b,
                       const struct voice_prosody *prosody) {
    if (a->say_as || b->say_as || a->phonemes || b->phonemes)
        return false;
    return a == b || (same(a->lang, b->lang) && same(a->voice, b->voice) && a->rate == b->rate &&
                      a->pitch == b->pitch && a->range == b->range && a->volume == b->volume &&
                      a->emphasis == b->emphasis &&
                      (!prosody->plays || (same(a->emotion.name, b->emotion.name) &&
                                           a->emotion.intensity == b->emotion.intensity)));
}

static char *copy_or_null(const char *s) {
    return s ? mem_strdup(s) : NULL;
}

static struct faccia_span *add_span(struct voice_request *request, uint32_t kind) {
    request->spans =
        mem_grow(request->spans, &request->span_cap, request->span_count + 1, sizeof *request->spans);
    struct faccia_span *span = &request->spans[request->span_count++];
    *span = (struct faccia_span){.kind = kind, .pitch = 1, .range = 1, .volume = 1};
    return span;
}

static void begin_text(struct voice_request *request, const struct score_style *style,
                       const struct voice_prosody *prosody) {
    struct faccia_span *span = add_span(request, FACCIA_SPAN_TEXT);
    request->last_bytes = request->last_cap = 0;
    span->lang = prosody->chosen ? NULL : copy_or_null(style->lang);
    span->phones = copy_or_null(style->phonemes);
    span->say_as = copy_or_null(style->say_as);
    span->emotion = prosody->plays ? copy_or_null(style->emotion.name) : NULL;
    span->intensity = span->emotion ? style->emotion.intensity : 0;
    span->rate = prosody->rate;
    if (style->rate != 1)
        span->rate = (prosody->rate > 0 ? prosody->rate : prosody->own_rate) * style->rate;
    span->pitch = prosody->pitch * style->pitch;
    span->range = style->range;
    span->volume = prosody->volume * style->volume;
    span->emphasis = (uint32_t)style->emphasis;
}

static void add_text(struct voice_request *request, const struct score_item *item) {
    struct faccia_span *span = &request->spans[request->span_count - 1];
    size_t before = request->last_bytes, bytes = strlen(item->text);
    char *text = mem_grow((char *)span->text, &request->last_cap, before + bytes + 1, 1);
    memcpy(text + before, item->text, bytes + 1);
    span->text = text;
    request->last_bytes += bytes;
    request->text_bytes += bytes;
    const struct score_part whole = {0, bytes, item->start, item->end, item->verbatim, false};
    const struct score_part *parts = item->parts ? item->parts : &whole;
    size_t count = item->parts ? item->part_count : 1;
    request->pieces =
        mem_grow(request->pieces, &request->piece_cap, request->piece_count + count, sizeof *request->pieces);
    for (size_t i = 0; i < count; i++)
        request->pieces[request->piece_count++] = (struct request_piece){
            .span = (uint32_t)(request->span_count - 1),
            .offset = before + parts[i].offset,
            .bytes = parts[i].bytes,
            .from = parts[i].start,
            .to = parts[i].end,
            .verbatim = parts[i].verbatim,
        };
}

/* Adds the part of the cue that lies in the sentence, if any. A point belongs to the item after it, at the
 * very end to the last sentence. */
static void add_cue(struct voice_request *request, const struct score *score, const struct score_sentence *s,
                    const struct score_cue *cue) {
    size_t end = s->first + s->count, first = cue->first, last = cue->last;
    bool at_the_end = first == score->item_count && end == score->item_count;
    bool point = first == last;
    if (point ? (first < s->first || first >= end) && !at_the_end : last <= s->first || first >= end)
        return;
    struct request_cue mine = {.intensity = cue->intensity,
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
    request->cues = mem_grow(request->cues, &request->cue_cap, request->cue_count + 1, sizeof *request->cues);
    request->cues[request->cue_count++] = mine;
}

static void turn_round(struct request_cue *cues, size_t count) {
    for (size_t i = 0; i < count / 2; i++) {
        struct request_cue cue = cues[i];
        cues[i] = cues[count - 1 - i];
        cues[count - 1 - i] = cue;
    }
}

void voice_request_cues(struct voice_request *request, const struct score *score, size_t sentence) {
    const struct score_sentence *s = &score->sentences[sentence];
    size_t own = score_cues_from(score, s->first), end = s->first + s->count;
    *request = (struct voice_request){.from = s->start, .to = s->end};
    /* cues that continue from earlier sentences, from the innermost outwards */
    for (size_t i = own; i;)
        if (score->cues[i - 1].last > s->first)
            add_cue(request, score, s, &score->cues[--i]);
        else
            i = score->cues[i - 1].around;
    turn_round(request->cues, request->cue_count);
    for (size_t i = own; i < score->cue_count; i++) {
        if (score->cues[i].first >= end && end < score->item_count)
            break;
        add_cue(request, score, s, &score->cues[i]);
    }
}

static void add_items(struct voice_request *request, const struct score *score, size_t first, size_t count,
                      const struct voice_prosody *prosody) {
    const struct score_style *style = NULL; /* of the open text span */
    for (size_t i = first; i < first + count; i++) {
        const struct score_item *item = &score->items[i];
        if (item->kind == SCORE_TEXT) {
            if (!item->text || !*item->text)
                continue;
            if (!style || !joins_span(style, item->style, prosody))
                begin_text(request, item->style, prosody);
            style = item->style;
            add_text(request, item);
            continue;
        }
        style = NULL;
        if (item->kind == SCORE_MARK) {
            add_span(request, FACCIA_SPAN_MARK)->text = mem_strdup(item->text ? item->text : "");
        } else if (item->kind == SCORE_BREAK) {
            double seconds = isfinite(item->seconds) && item->seconds > 0 ? item->seconds : 0;
            add_span(request, FACCIA_SPAN_BREAK)->seconds = seconds;
            request->break_seconds += seconds;
        }
    }
}

void voice_request_make(struct voice_request *request, const struct score *score, size_t sentence,
                        const struct voice_prosody *prosody) {
    const struct score_sentence *s = &score->sentences[sentence];
    voice_request_cues(request, score, sentence);
    add_items(request, score, s->first, s->count, prosody);
}

void voice_request_items(struct voice_request *request, const struct score *score, size_t first, size_t count,
                         const struct voice_prosody *prosody) {
    *request = (struct voice_request){0};
    if (count) {
        request->from = score->items[first].start;
        request->to = score->items[first + count - 1].end;
    }
    add_items(request, score, first, count, prosody);
}

struct faccia_sentence voice_request_sentence(const struct voice_request *request, const char *voice) {
    return (struct faccia_sentence){.voice = voice,
                                    .spans = request->spans,
                                    .span_count = request->span_count,
                                    .before = request->before,
                                    .after = request->after};
}

void voice_request_continue(struct voice_request *request) {
    struct faccia_span *last = NULL;
    for (size_t i = 0; i < request->span_count; i++)
        if (request->spans[i].kind == FACCIA_SPAN_TEXT)
            last = &request->spans[i];
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
    request->text_bytes++;
}

void voice_request_free(struct voice_request *request) {
    for (size_t i = 0; i < request->span_count; i++) {
        struct faccia_span *span = &request->spans[i];
        free((char *)span->text);
        free((char *)span->lang);
        free((char *)span->phones);
        free((char *)span->say_as);
        free((char *)span->emotion);
    }
    for (size_t i = 0; i < request->cue_count; i++) {
        free((char *)request->cues[i].kind);
        free((char *)request->cues[i].name);
    }
    free(request->before);
    free(request->after);
    free(request->cues);
    free(request->spans);
    free(request->pieces);
    *request = (struct voice_request){0};
}

static bool inside_character(const char *text, size_t at) {
    return ((unsigned char)text[at] & 0xC0) == 0x80;
}

/* Clips the range to the span's text and widens it to whole characters. Returns false when nothing is
 * left. */
static bool clip(const struct voice_request *request, uint32_t span, size_t *offset, size_t bytes,
                 size_t *end) {
    if (span >= request->span_count || request->spans[span].kind != FACCIA_SPAN_TEXT)
        return false;
    const char *text = request->spans[span].text;
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

char *voice_request_text(const struct voice_request *request, uint32_t span, size_t offset, size_t bytes) {
    size_t end;
    return clip(request, span, &offset, bytes, &end)
               ? mem_strndup(request->spans[span].text + offset, end - offset)
               : mem_strdup("");
}

bool voice_request_locate(const struct voice_request *request, uint32_t span, size_t offset, size_t bytes,
                          size_t *from, size_t *to) {
    size_t end;
    if (!clip(request, span, &offset, bytes, &end))
        return false;
    bool found = false;
    for (size_t i = 0; i < request->piece_count; i++) {
        const struct request_piece *p = &request->pieces[i];
        if (p->span != span || p->offset + p->bytes <= offset || p->offset >= end)
            continue;
        if (!found)
            *from = p->verbatim && offset > p->offset ? p->from + (offset - p->offset) : p->from;
        *to = p->verbatim && end < p->offset + p->bytes ? p->from + (end - p->offset) : p->to;
        found = true;
    }
    return found;
}

#define SPACES " \n\t\r"

static const char *text_of(const struct score_item *item) {
    return item->kind == SCORE_TEXT && item->text ? item->text : "";
}

/* Returns the text of items [from, to), with a space between sentences; `sentence` contains item `from`. */
static char *text_between(const struct score *score, size_t sentence, size_t from, size_t to) {
    struct buf b = {0};
    for (size_t i = from; i < to; i++) {
        while (sentence + 1 < score->sentence_count && i >= score->sentences[sentence + 1].first) {
            sentence++;
            buf_add(&b, " ", 1);
        }
        buf_add(&b, text_of(&score->items[i]), strlen(text_of(&score->items[i])));
    }
    buf_add(&b, "", 1);
    return (char *)b.data;
}

/* Drops the first words of a text that is too long. */
static void keep_end(char *text) {
    size_t length = strlen(text);
    if (length <= VOICE_CONTEXT_BYTES)
        return;
    size_t from = length - VOICE_CONTEXT_BYTES;
    from += strcspn(text + from, SPACES);
    memmove(text, text + from, length - from + 1);
}

static void keep_beginning(char *text) {
    size_t to = VOICE_CONTEXT_BYTES;
    if (strlen(text) <= to)
        return;
    while (to && !strchr(SPACES, text[to]))
        to--;
    text[to] = '\0';
}

static char *or_none(char *text) {
    if (text[strspn(text, SPACES)])
        return text;
    free(text);
    return NULL;
}

void voice_request_context(struct voice_request *request, const struct score *score, size_t sentence,
                           size_t first, size_t count) {
    size_t from = first, to = first + count, earlier = sentence;
    /* limit the number of items too: most may be marks without text */
    for (size_t bytes = 0; from && bytes <= VOICE_CONTEXT_BYTES && first - from < VOICE_CONTEXT_BYTES;)
        bytes += strlen(text_of(&score->items[--from]));
    for (size_t bytes = 0;
         to < score->item_count && bytes <= VOICE_CONTEXT_BYTES && to - first - count < VOICE_CONTEXT_BYTES;)
        bytes += strlen(text_of(&score->items[to++]));
    while (earlier && score->sentences[earlier].first > from)
        earlier--;
    request->before = text_between(score, earlier, from, first);
    request->after = text_between(score, sentence, first + count, to);
    keep_end(request->before);
    keep_beginning(request->after);
    request->before = or_none(request->before);
    request->after = or_none(request->after);
}
