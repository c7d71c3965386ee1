/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splits the pieces of a passage into runs where the style or word changes, and finds its zones. */
#include "server/base/mem.h"
#include "server/markup/passage_internal.h"

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

void passage_warn_word(struct passage *p, size_t at, const char *what) {
    if (p->warned == at + 1)
        return;
    p->warned = at + 1;
    score_warn(p->score, at, ERROR_INSIDE_WORD, "%s", what);
}

void passage_make_runs(struct flush *f) {
    struct passage *p = f->p;
    for (size_t i = 0; i < p->piece_count; i++) {
        const struct piece *piece = &p->pieces[i];
        struct word word;
        if (piece->kind == SCORE_TEXT) {
            cut_text(f, i);
        } else if (piece->kind == SCORE_MARK && passage_word(p, 0, piece->flat, &word)) {
            passage_warn_word(p, piece->start, "the mark lies inside a word: it is reported after the word");
            f->marks = mem_grow(f->marks, &f->mark_cap, f->mark_count + 1, sizeof *f->marks);
            f->marks[f->mark_count++] = i;
            f->marks_until = word.to;
        } else {
            add_run(f, i, piece->flat, piece->flat, piece->style);
        }
    }
    release_marks(f);
}

void passage_make_zones(struct flush *f) {
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
