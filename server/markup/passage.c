/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/passage.h"
#include "server/base/mem.h"
#include "server/markup/white.h"
#include <stdlib.h>
#include <string.h>

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
