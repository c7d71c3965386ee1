/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text that is still being written: what its writer does, and does not do in time. */
#include "server/base/mem.h"
#include "server/synthesis/synthesis_internal.h"
#include <stdlib.h>
#include <string.h>

/* What looks like a sentence's end, and is followed by nothing for so long, is one: people and programs pause
 * there. Between two words of a language model that is slow lie 50 ms. */
enum { SETTLE_MS = 200 };

/* The same where it can hardly be anything else, and a program writes, not a person letter by letter: such
 * write a token in less than BRISK_MS on average. */
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

/* While the voices are still starting (no score), the language's rules are not known: nothing is read yet. */
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
    guess_look(s);
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
           s->samples < UINT32_MAX / 2; /* what is said later needs the clock, too */
}

/* Nobody has written for long: what there is is spoken, and those who wait get their turn. */
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
