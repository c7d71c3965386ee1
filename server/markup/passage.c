/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/passage.h"
#include "server/base/mem.h"
#include "server/markup/plain.h"
#include <stdlib.h>
#include <string.h>

/* A part of a piece with a single style. */
struct run {
    size_t piece; /* index; never decreases from run to run */
    size_t from, to;
    const struct piece *of;
    const struct score_style *style;
};

/* A range of the flat text in which no sentence may end. */
struct zone {
    size_t from, to;
};

struct flush {
    struct passage *p;
    struct run *runs;
    size_t run_count, run_cap;
    size_t *marks; /* marks inside a word that ends at marks_until; they follow it */
    size_t mark_count, mark_cap, marks_until;
    size_t cut;
    struct word styled; /* cache of word_style: the last word and its style */
    const struct score_style *word_style;
    struct zone *zones;
    size_t zone_count, zone_cap, zone;
    struct run *placed; /* origin of each new item */
    size_t placed_count, placed_cap, first_item;
};

/* ---- runs of one style, and zones in which no sentence may end ---- */

static void passage_warn_word(struct passage *p, size_t at, const char *what); /* at most once per position */

static void put_run(struct flush *f, struct run run) {
    f->runs = mem_grow(f->runs, &f->run_cap, f->run_count + 1, sizeof *f->runs);
    f->runs[f->run_count++] = run;
}

static void release_marks(struct flush *f) {
    for (size_t i = 0; i < f->mark_count; i++) {
        const struct piece *mark = &f->p->pieces[f->marks[i]];
        struct run last = f->runs[f->run_count - 1];
        put_run(f, (struct run){last.piece, last.to, last.to, mark, mark->style});
    }
    f->mark_count = 0;
}

static void add_run(struct flush *f, size_t piece, size_t from, size_t to, const struct score_style *style) {
    if (f->mark_count && from >= f->marks_until)
        release_marks(f);
    put_run(f, (struct run){piece, from, to, &f->p->pieces[piece], style});
}

/* Style of a word around one end of the piece: the innermost element decides. */
static const struct score_style *word_style(struct flush *f, size_t piece, struct word word) {
    const struct passage *p = f->p;
    if (f->styled.from == word.from && f->styled.to == word.to)
        return f->word_style;
    const struct piece *best = &p->pieces[piece];
    for (size_t i = piece; i-- && p->pieces[i].flat + p->pieces[i].bytes > word.from;)
        if (p->pieces[i].kind == SCORE_TEXT && p->pieces[i].depth >= best->depth)
            best = &p->pieces[i];
    for (size_t i = piece + 1; i < p->piece_count && p->pieces[i].flat < word.to; i++)
        if (p->pieces[i].kind == SCORE_TEXT && p->pieces[i].depth > best->depth)
            best = &p->pieces[i];
    f->styled = word;
    f->word_style = best->style;
    return best->style;
}

static void cut_text(struct flush *f, size_t index) {
    struct passage *p = f->p;
    const struct piece *piece = &p->pieces[index];
    size_t at = piece->flat, end = piece->flat + piece->bytes, head = at, tail = end;
    const struct score_style *head_style = NULL, *tail_style = NULL;
    struct word word;
    if (passage_word(p, 0, at, &word)) {
        head = word.to < end ? word.to : end;
        head_style = word_style(f, index, word);
    }
    if (passage_word(p, 0, end, &word)) {
        tail = word.from > at ? word.from : at;
        tail_style = word_style(f, index, word);
    }
    while (at < end) {
        size_t next = at < head ? head : at < tail ? tail : end;
        while (f->cut < p->cut_count && p->cuts[f->cut] <= at)
            f->cut++;
        if (f->cut < p->cut_count && p->cuts[f->cut] < next)
            next = p->cuts[f->cut];
        add_run(f, index, at, next, at < head ? head_style : at >= tail ? tail_style : piece->style);
        at = next;
    }
}

static void passage_warn_word(struct passage *p, size_t at, const char *what) {
    if (p->warned == at + 1)
        return;
    p->warned = at + 1;
    score_warn(p->score, at, ERROR_INSIDE_WORD, "%s", what);
}

static void passage_make_runs(struct flush *f) {
    struct passage *p = f->p;
    for (size_t i = 0; i < p->piece_count; i++) {
        const struct piece *piece = &p->pieces[i];
        struct word word;
        if (piece->kind == SCORE_TEXT) {
            cut_text(f, i);
        } else if (piece->kind == SCORE_MARK && passage_word(p, 0, piece->flat, &word)) {
            passage_warn_word(p, piece->start, "the mark is inside a word: it is reported after the word");
            f->marks = mem_grow(f->marks, &f->mark_cap, f->mark_count + 1, sizeof *f->marks);
            f->marks[f->mark_count++] = i;
            f->marks_until = word.to;
        } else {
            add_run(f, i, piece->flat, piece->flat, piece->style);
        }
    }
    release_marks(f);
}

static void passage_make_zones(struct flush *f) {
    const struct passage *p = f->p;
    size_t covered = 0;
    for (size_t i = 0; i < p->piece_count; i++) {
        const struct piece *piece = &p->pieces[i];
        size_t to = piece->flat + piece->bytes;
        if (piece->kind == SCORE_AUDIO)
            to = piece->until < p->piece_count ? p->pieces[piece->until].flat : p->flat.size;
        else if (!piece->atomic)
            continue;
        if (to <= covered || to <= piece->flat + 1)
            continue;
        f->zones = mem_grow(f->zones, &f->zone_cap, f->zone_count + 1, sizeof *f->zones);
        f->zones[f->zone_count++] = (struct zone){piece->flat, to};
        covered = to;
    }
}

/* ---- items of the score ---- */

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
        passage_warn_word(p, span->at, "this begins or ends inside a word: it applies to the whole word");
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

void passage_free(struct passage *p) {
    buf_free(&p->flat);
    free(p->pieces);
    free(p->spans);
    free(p->barriers);
    free(p->cuts);
    *p = (struct passage){0};
}

static void add_barrier(struct passage *p) {
    if (p->barrier_count && p->barriers[p->barrier_count - 1] == p->flat.size)
        return;
    p->barriers = mem_grow(p->barriers, &p->barrier_cap, p->barrier_count + 1, sizeof *p->barriers);
    p->barriers[p->barrier_count++] = p->flat.size;
}

/* Line ends on both sides of a tag do not make a blank line. */
static void join_lines(struct passage *p, size_t from) {
    char *s = (char *)p->flat.data;
    for (size_t at = from; at < p->flat.size && is_white(s[at]); at++)
        if (s[at] == '\n')
            s[at] = ' ';
}

/* Updates line_ended after text was added at `from`. */
static void note_line_end(struct passage *p, size_t from) {
    const char *s = (const char *)p->flat.data;
    size_t at = p->flat.size;
    while (at > from && is_white(s[at - 1]) && s[at - 1] != '\n')
        at--;
    if (at > from)
        p->line_ended = s[at - 1] == '\n';
}

void passage_text(struct passage *p, const char *text, size_t n, struct piece piece) {
    struct piece *last = p->piece_count ? &p->pieces[p->piece_count - 1] : NULL;
    bool follows = last && last->kind == SCORE_TEXT && last->end == piece.start;
    size_t from = p->flat.size;
    piece.verbatim = n == piece.end - piece.start && !memcmp(text, p->text + piece.start, n);
    if (piece.atomic)
        add_barrier(p);
    buf_add(&p->flat, text, n);
    if (!follows && p->line_ended)
        join_lines(p, from);
    note_line_end(p, from);
    if (follows && piece.verbatim && last->verbatim && !piece.atomic && !last->atomic &&
        last->style == piece.style) {
        last->bytes += n;
        last->end = piece.end;
        return;
    }
    piece.kind = SCORE_TEXT;
    piece.bytes = n;
    passage_add(p, piece);
    p->pieces[p->piece_count - 1].flat = from;
    if (piece.atomic)
        add_barrier(p);
}

size_t passage_add(struct passage *p, struct piece piece) {
    p->pieces = mem_grow(p->pieces, &p->piece_cap, p->piece_count + 1, sizeof *p->pieces);
    if (piece.kind == SCORE_BREAK || piece.kind == SCORE_AUDIO)
        add_barrier(p);
    piece.flat = p->flat.size;
    p->pieces[p->piece_count] = piece;
    return p->piece_count++;
}

static struct span *add_span(struct passage *p, size_t cue, size_t at, size_t depth) {
    p->spans = mem_grow(p->spans, &p->span_cap, p->span_count + 1, sizeof *p->spans);
    struct span *span = &p->spans[p->span_count++];
    *span = (struct span){.cue = cue,
                          .at = at,
                          .depth = depth,
                          .first = p->piece_count,
                          .last = p->piece_count,
                          .first_flat = p->flat.size,
                          .last_flat = p->flat.size,
                          .ended = true};
    return span;
}

bool passage_open(struct passage *p, size_t cue, size_t at, size_t depth) {
    struct span *span = add_span(p, cue, at, depth);
    if (p->open_count == PASSAGE_OPEN)
        return false;
    span->ended = false;
    p->open[p->open_count++] = p->span_count - 1;
    return true;
}

void passage_from(struct passage *p, size_t piece) {
    struct span *span = &p->spans[p->span_count - 1];
    span->first = piece;
    span->first_flat = piece < p->piece_count ? p->pieces[piece].flat : p->flat.size;
}

void passage_close(struct passage *p, size_t depth) {
    for (; p->open_count && p->spans[p->open[p->open_count - 1]].depth >= depth; p->open_count--) {
        struct span *span = &p->spans[p->open[p->open_count - 1]];
        span->ended = true;
        span->last = p->piece_count;
        span->last_flat = p->flat.size;
    }
}

void passage_lift(struct passage *p, size_t depth) {
    for (size_t i = p->open_count; i-- && p->spans[p->open[i]].depth >= depth;)
        p->spans[p->open[i]].depth = depth - 1;
}

void passage_last_word(struct passage *p, size_t cue, size_t at) {
    struct word word;
    struct span *span = add_span(p, cue, at, 0);
    if (!passage_word_before(p, &word))
        return;
    span->back = true;
    span->first_flat = word.from;
    p->cuts = mem_grow(p->cuts, &p->cut_cap, p->cut_count + 1, sizeof *p->cuts);
    p->cuts[p->cut_count++] = word.from;
}
