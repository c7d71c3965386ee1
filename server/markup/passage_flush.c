/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a complete passage to items, sentences and cues of the score. */
#include "server/base/mem.h"
#include "server/markup/passage_internal.h"
#include "server/markup/plain.h"
#include "server/markup/white.h"
#include <stdlib.h>
#include <string.h>

/* A sentence with this many items ends at the next mark or break: there may be many without a word. */
enum { SENTENCE_ITEMS = 1000 };

/* End of the sentence that begins at `at`. A sentence marked by the author ends early only if it is too
 * long. */
static size_t sentence_end(struct flush *f, size_t at) {
    const char *s = (const char *)f->p->flat.data;
    size_t size = f->p->flat.size, end = at;
    do {
        size_t next = end + (end < size ? plain_sentence(s + end, size - end, &f->p->rules) : 0);
        if (f->p->whole && end > at && next - at > PLAIN_SENTENCE_BYTES)
            break;
        end = next;
        while (f->zone < f->zone_count && f->zones[f->zone].to <= end)
            f->zone++;
        if (f->zone < f->zone_count && f->zones[f->zone].from < end)
            end = f->zones[f->zone].to;
    } while (f->p->whole && end < size);
    return end;
}

static void emit(struct flush *f, const struct run *run, size_t from, size_t to) {
    struct passage *p = f->p;
    const struct piece *piece = run->of;
    f->placed = mem_grow(f->placed, &f->placed_cap, f->placed_count + 1, sizeof *f->placed);
    f->placed[f->placed_count++] = (struct run){run->piece, from, to, piece, run->style};
    size_t start = piece->start, end = piece->end;
    if (piece->verbatim) {
        start += from - piece->flat;
        end = start + (to - from);
    }
    struct score_item *item = score_add(p->score, piece->kind, start, end);
    item->style = run->style;
    item->verbatim = piece->verbatim;
    item->given = piece->given;
    item->seconds = piece->seconds;
    item->text = piece->name;
    if (piece->kind == SCORE_TEXT)
        item->text = piece->verbatim ? score_strndup(p->score, p->text + start, end - start)
                                     : score_strndup(p->score, (char *)p->flat.data + from, to - from);
}

static void make_items(struct flush *f) {
    struct passage *p = f->p;
    const char *s = (const char *)p->flat.data;
    size_t at = 0, run = 0, sound = 0; /* pieces before `sound` belong to a sound */
    while (at < p->flat.size && is_white(s[at]))
        at++;
    while (at < p->flat.size || run < f->run_count) {
        size_t end = sentence_end(f, at), from = at, to = end;
        while (from < to && is_white(s[from]))
            from++;
        while (to > from && is_white(s[to - 1]))
            to--;
        bool last = end == p->flat.size;
        size_t items = p->score->item_count;
        for (; run < f->run_count; run++) {
            const struct run *r = &f->runs[run];
            if (!last && r->from >= end && r->piece >= sound)
                break;
            if (r->of->kind == SCORE_AUDIO && r->of->until > sound)
                sound = r->of->until;
            size_t a = r->from > from ? r->from : from, b = r->to < to ? r->to : to;
            if (r->of->kind != SCORE_TEXT) {
                emit(f, r, r->from, r->from);
                if (f->p->score->item_count - items >= SENTENCE_ITEMS && r->piece >= sound) {
                    score_end_sentence(f->p->score);
                    items = f->p->score->item_count;
                }
            } else if (a < b) {
                emit(f, r, a, b);
            }
            if (r->to > end)
                break;
        }
        score_end_sentence(p->score);
        at = end;
    }
}

/* Index of the first new item that comes from piece `key` or a later one, ends after or begins at offset
 * `key`. */
enum where { OF_PIECE, ENDS_AFTER, BEGINS_AT };

static size_t find_item(const struct flush *f, enum where where, size_t key) {
    size_t low = 0, high = f->placed_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        const struct run *r = &f->placed[middle];
        bool before = where == OF_PIECE ? r->piece < key : where == ENDS_AFTER ? r->to <= key : r->from < key;
        if (before)
            low = middle + 1;
        else
            high = middle;
    }
    return f->first_item + low;
}

static void place_span(struct flush *f, struct span *span) {
    struct passage *p = f->p;
    size_t first = 0, last = 0;
    struct word word;
    bool inside = false, empty = span->ended && !span->back && span->first == span->last;
    if (!span->begun) {
        if (!span->back && !empty && passage_word(p, 0, span->first_flat, &word)) {
            inside = true;
            first = find_item(f, ENDS_AFTER, word.from);
        } else {
            first =
                span->back ? find_item(f, ENDS_AFTER, span->first_flat) : find_item(f, OF_PIECE, span->first);
        }
    }
    if (span->ended) {
        if (!empty && !span->back && passage_word(p, 1, span->last_flat, &word)) {
            inside = true;
            last = find_item(f, BEGINS_AT, word.to);
        } else {
            last = find_item(f, OF_PIECE, span->last);
        }
    }
    if (inside)
        passage_warn_word(p, span->at, "this begins or ends inside a word: it holds for the whole word");
    if (span->cue != SPAN_STYLE) {
        struct score_cue *cue = &p->score->cues[span->cue];
        if (!span->begun)
            cue->first = first;
        cue->last = span->ended && last > cue->first ? last : cue->first;
    }
    span->begun = true;
}

static void place_sounds(struct flush *f) {
    for (size_t i = 0; i < f->placed_count; i++)
        if (f->placed[i].of->kind == SCORE_AUDIO) {
            size_t item = f->first_item + i;
            f->p->score->items[item].fallback = find_item(f, OF_PIECE, f->placed[i].of->until) - item - 1;
        }
}

void passage_flush(struct passage *p) {
    if (!p->piece_count && p->span_count == p->open_count)
        return;
    struct flush f = {.p = p, .first_item = p->score->item_count};
    passage_make_runs(&f);
    passage_make_zones(&f);
    make_items(&f);
    place_sounds(&f);
    size_t kept = 0;
    for (size_t i = 0; i < p->span_count; i++) {
        struct span *span = &p->spans[i];
        place_span(&f, span);
        if (!span->ended) {
            span->first = span->first_flat = 0;
            p->open[kept] = kept;
            p->spans[kept++] = *span;
        }
    }
    p->flushes++;
    p->line_ended = false;
    memset(p->words, 0, sizeof p->words);
    p->span_count = kept;
    p->piece_count = p->barrier_count = p->cut_count = p->flat.size = 0;
    free(f.runs);
    free(f.marks);
    free(f.zones);
    free(f.placed);
}
