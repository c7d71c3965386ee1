/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/recording/match.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

static void add(struct text_words *tokens, const char *text) {
    if (text)
        text_words_add(tokens, text, strlen(text), 0);
}

void match_words(struct match *m, const struct faccia_sentence *sentence) {
    m->sentence = sentence;
    add(&m->before, sentence->before);
    add(&m->after, sentence->after);
    for (uint32_t s = 0; s < sentence->span_count; s++) {
        const struct faccia_span *span = &sentence->spans[s];
        if (span->kind != FACCIA_SPAN_TEXT || !span->text)
            continue;
        size_t before = m->tokens.count;
        add(&m->tokens, span->text);
        m->spans = mem_grow(m->spans, &m->cap, m->tokens.count + 1, sizeof *m->spans);
        for (size_t i = before; i < m->tokens.count; i++)
            m->spans[i] = s;
    }
}

void match_free(struct match *m) {
    text_words_free(&m->tokens);
    text_words_free(&m->before);
    text_words_free(&m->after);
    free(m->spans);
}

int match_find(struct match *m, const struct aligned_recording *reading, size_t from, struct error *e) {
    const struct text_words *in = &reading->tokens;
    size_t count = m->tokens.count, most = 0, place;
    m->at = SIZE_MAX;
    for (size_t at = 0; (at = text_words_find(in, m->tokens.list, count, at)) != SIZE_MAX; at++) {
        size_t agree = text_words_up_to(in, at, &m->before) + text_words_from(in, at + count, &m->after);
        if (m->at != SIZE_MAX && (agree < most || (agree == most && (m->at >= from || at < from))))
            continue;
        m->at = at;
        most = agree;
    }
    if (m->at != SIZE_MAX)
        return 0;
    size_t agree = text_words_longest(in, m->tokens.list, count, &place);
    const struct text_word *asked = &m->tokens.list[agree];
    const char *text = m->sentence->spans[m->spans[agree]].text;
    int length = (int)(asked->to - asked->from);
    if (!agree)
        return error_set(e, ERROR_VOICE_FAILED, "this is not in the recording: it has no word \"%.*s\"",
                         length, text + asked->from);
    const struct text_word *other = place + agree < in->count ? &in->list[place + agree] : NULL;
    return error_set(e, ERROR_VOICE_FAILED,
                     "this is not in the recording: after %zu words it has \"%.*s\" instead of \"%.*s\"",
                     agree, other ? (int)(other->to - other->from) : 0,
                     other ? reading->text + other->from : "", length, text + asked->from);
}

uint64_t match_time(const struct match *m, const struct aligned_recording *reading, size_t word, bool end,
                    uint64_t from, uint64_t samples) {
    const struct aligned_recording_word *w = &reading->words[m->at + word];
    double at = (end ? w->end : w->start) * reading->sound->rate - (double)from;
    return at <= 0 ? 0 : at >= (double)samples ? samples : (uint64_t)at;
}
