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
    struct reading_result r = {0};
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
    synthesis_direct(s, &r);
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

/* A likely sentence end followed by this much silence is one: people and programs pause there. A slow
 * language model takes about 50 ms between words. */
enum { SETTLE_MS = 200 };

/* The same for an almost certain end in a text written by a program, recognised by an average below
 * BRISK_MS between writes. */
enum { SURE_MS = 13, BRISK_MS = 80 };

static void on_timer(uv_timer_t *timer);

static uint64_t now_of(const struct synthesis *s) {
    return uv_now(s->pipeline->loop);
}

void writing_open(struct synthesis *s) {
    struct writing *w = s->writing = mem_alloc(sizeof *w);
    w->open.kind = markup_by_name(s->request.markup ? s->request.markup : "auto");
    w->timer = mem_alloc(sizeof *w->timer);
    uv_timer_init(s->pipeline->loop, w->timer);
    w->timer->data = s;
    w->look = on_timer;
    w->last = now_of(s);
    w->settle = SETTLE_MS;
    w->text_cap = s->request.text ? s->request.text_size + 1 : 0;
    size_t bad = s->request.text ? utf8_feed(&w->utf8, s->request.text, s->request.text_size) : 0;
    if (bad < s->request.text_size)
        error_at_byte(&w->error, ERROR_BAD_UTF8, bad, "the text is not UTF-8");
    writing_wake(s, SETTLE_MS);
}

/* Without a score the voices are still starting and the language's rules are unknown, so nothing is
 * parsed. */
static bool surely_ended(const struct synthesis *s) {
    if (!s->score)
        return false;
    struct markup_rules rules = synthesis_rules(s);
    return open_text_surely_ended(&s->writing->open, s->request.text, s->request.text_size, &rules);
}

static void wrote(struct synthesis *s) {
    struct writing *w = s->writing;
    w->last = now_of(s);
    w->first = w->writes++ ? w->first : w->last;
    bool brisk = w->writes > 2 && w->last - w->first < BRISK_MS * (w->writes - 1);
    w->settle = brisk && surely_ended(s) ? SURE_MS : SETTLE_MS;
    writing_wake(s, w->settle);
}

int synthesis_write(struct synthesis *s, const char *text, size_t size, size_t most, struct error *e) {
    struct writing *w = s->writing;
    if (!w || w->closed || w->error.code != ERROR_NONE)
        return 0;
    size_t before = s->request.text_size;
    if (size > most || before > most - size)
        return error_in_field(e, ERROR_TEXT_TOO_LONG, "text", "a text may have at most %zu bytes", most);
    const char *nul = memchr(text, '\0', size);
    if (nul)
        return error_at_byte(e, ERROR_NUL, before + (size_t)(nul - text), "the text holds a NUL character");
    struct utf8_reader utf8 = w->utf8;
    size_t bad = utf8_feed(&utf8, text, size);
    if (bad < size)
        return error_at_byte(e, ERROR_BAD_UTF8, before + bad, "the text is not UTF-8");
    w->utf8 = utf8;
    s->request.text = mem_grow(s->request.text, &w->text_cap, before + size + 1, 1);
    memcpy(s->request.text + before, text, size);
    s->request.text_size = before + size;
    s->request.text[s->request.text_size] = '\0';
    wrote(s);
    synthesis_submit(s);
    speculation_check(s);
    return 0;
}

static void flush(struct synthesis *s) {
    struct writing *w = s->writing;
    size_t size = s->request.text_size;
    if (!size || (w->flush_count && w->flushes[w->flush_count - 1] == size))
        return;
    w->flushes = mem_grow(w->flushes, &w->flush_cap, w->flush_count + 1, sizeof *w->flushes);
    w->flushes[w->flush_count++] = size;
    synthesis_submit(s);
}

void synthesis_flush(struct synthesis *s) {
    if (!s->writing || s->writing->closed)
        return;
    s->writing->last = now_of(s);
    flush(s);
}

void synthesis_close(struct synthesis *s) {
    if (!s->writing || s->writing->closed)
        return;
    s->writing->closed = true;
    writing_wake(s, 0);
    synthesis_submit(s);
}

bool synthesis_is_open(const struct synthesis *s) {
    return s->writing && !s->writing->closed;
}

bool synthesis_awaits_text(const struct synthesis *s) {
    return synthesis_is_open(s) && s->score && s->delivered == s->score->sentence_count &&
           s->samples < UINT32_MAX / 2; /* later speech needs the clock, too */
}

/* Closes a text that was idle for too long, so that others get their turn. */
static void give_up(struct synthesis *s) {
    struct error e;
    error_set(&e, ERROR_UNFINISHED, "nothing was written for %u s: the text is taken as it is",
              s->pipeline->open_seconds);
    s->busy = true;
    s->callbacks.problem(s->ctx, &e, true);
    s->busy = false;
    if (!s->freed)
        synthesis_close(s);
}

static void on_timer(uv_timer_t *timer) {
    struct synthesis *s = timer->data;
    struct writing *w = s->writing;
    uint64_t silent = now_of(s) - w->last, most = (uint64_t)s->pipeline->open_seconds * 1000;
    struct markup_rules rules;
    if (s->freed)
        return;
    if (!w->closed && most && silent >= most)
        give_up(s);
    if (s->freed) {
        synthesis_free(s);
        return;
    }
    if (!w->closed && silent >= w->settle && s->score && s->request.text) {
        rules = synthesis_rules(s);
        if (open_text_seems_ended(&w->open, s->request.text, s->request.text_size, &rules))
            flush(s);
    }
    if (!w->closed && (silent < w->settle || most))
        writing_wake(s, silent < w->settle ? w->settle - silent : most - silent);
    synthesis_deliver(s);
}
