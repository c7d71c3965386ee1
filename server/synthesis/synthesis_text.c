/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open texts: parsing piece by piece into a growing score, and timing of writes. */
#include "server/base/mem.h"
#include "server/synthesis/synthesis_internal.h"
#include <stdlib.h>
#include <string.h>

void writing_wake(struct synthesis *s, uint64_t ms) {
    uv_timer_start(s->writing->timer, s->writing->look, ms, 0);
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

void writing_free(struct synthesis *s) {
    struct writing *w = s->writing;
    if (!w)
        return;
    uv_close((uv_handle_t *)w->timer, free_timer);
    open_text_free(&w->open);
    free(w->flushes);
    free(w);
    s->writing = NULL;
}

void writing_begin(struct synthesis *s) {
    s->result.score = score_new();
    s->score = s->result.score;
    s->chosen = s->result.chosen = voice_selection_new(0);
}

static void add_warnings(const struct synthesis *s, struct score *all, const struct score *script,
                         const struct open_piece *piece) {
    for (size_t i = 0; i < script->warning_count && all->warning_count < SCORE_WARNINGS; i++) {
        struct error warning = script->warnings[i];
        open_piece_place(piece, s->request.text, &warning);
        all->warnings =
            mem_grow(all->warnings, &all->warning_cap, all->warning_count + 1, sizeof *all->warnings);
        all->warnings[all->warning_count++] = warning;
    }
}

static size_t place(const void *piece, size_t byte) {
    return open_piece_byte(piece, byte);
}

/* Detects the kind from the first piece. */
static int learn_kind(struct synthesis *s, struct error *e) {
    if (s->markup == s->writing->open.kind)
        return 0;
    s->markup = s->writing->open.kind;
    return synthesis_choose(s, e);
}

int writing_read_piece(struct synthesis *s, const struct open_piece *piece, struct reading_result *into,
                       struct error *e) {
    struct unspoken_told ahead = s->writing->unspoken; /* a sentence spoken ahead is read once more */
    struct reading_result r = {.told = into == &s->result ? &s->writing->unspoken : &ahead};
    struct markup_rules rules;
    if (learn_kind(s, e))
        return -1;
    rules = synthesis_rules(s);
    rules.markdown = s->writing->open.markdown;
    rules.paused = s->writing->paused;
    /* text after a broken element could not be attributed, so it is an error */
    rules.lenient = rules.lenient && s->markup == markup_by_name("plain");
    r.document = markup_read(s->markup, piece->text, piece->size, &rules, e);
    if (!r.document && e->code == ERROR_EMPTY_TEXT)
        return 0;
    if (!r.document) {
        open_piece_place(piece, s->request.text, e);
        return -1;
    }
    s->voices = voice_pool_retain(s->pipeline->voices);
    synthesis_direct(s, &r, NULL);
    voice_pool_release(s->pipeline->voices);
    if (into == &s->result)
        s->writing->paused += score_pauses(r.document);
    add_warnings(s, into->score, r.score, piece);
    score_append(into->score, r.score, place, piece);
    voice_selection_append(into->chosen, r.chosen);
    into->marks |= r.marks;
    if (r.blend == BLEND_WEIGHTED)
        into->blend = r.blend;
    voice_selection_free(r.chosen);
    score_free(r.score);
    score_free(r.document);
    return 0;
}

/* Returns 1 when a piece was parsed, 0 when more text is needed, -1 on error. */
static int read_on(struct synthesis *s, struct error *e) {
    struct writing *w = s->writing;
    struct markup_rules rules = synthesis_rules(s);
    struct open_piece piece;
    for (;;) {
        bool flushed = w->flush < w->flush_count;
        size_t size = flushed ? w->flushes[w->flush] : s->request.text_size;
        enum open_end end = flushed ? OPEN_FLUSHED : w->closed ? OPEN_CLOSED : OPEN_GOES_ON;
        int found =
            s->request.text ? open_text_next(&w->open, s->request.text, size, end, &rules, &piece, e) : 0;
        if (found > 0) {
            int result = writing_read_piece(s, &piece, &s->result, e);
            free(piece.text);
            return result ? -1 : 1;
        }
        if (found < 0 || !flushed)
            return found;
        w->flush++;
    }
}

bool writing_read(struct synthesis *s) {
    struct writing *w = s->writing;
    size_t sentences = s->score->sentence_count;
    int result = w->error.code != ERROR_NONE ? -1 : 1;
    while (!w->read && result > 0 && s->score->sentence_count == sentences)
        result = read_on(s, &w->error);
    if (!w->read && result <= 0 && (result < 0 || w->closed)) {
        w->read = w->closed = true;
        if (!result && !s->score->sentence_count)
            error_set(&w->error, ERROR_EMPTY_TEXT, "there is nothing to speak");
        writing_wake(s, 0); /* to report it */
    }
    if (s->score->warning_count > s->warned)
        writing_wake(s, 0);
    return s->score->sentence_count > sentences;
}
