/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/festival/festival_internal.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AUDIO_SECONDS_MAX 600

void fe_piece_begin(struct fe_piece *piece, const struct fe_voice *voice, const struct faccia_sink *sink) {
    *piece = (struct fe_piece){.voice = voice, .sink = sink, .sample_rate = voice->info.sample_rate};
}

void fe_piece_free(struct fe_piece *piece) {
    fe_tokens_free(&piece->tokens);
    free(piece->prosody);
    free(piece->marks);
    free(piece->phones);
    free(piece->words);
}

void fe_piece_add(struct fe_piece *piece, uint32_t span, const char *text, bool spell,
                  const struct fe_prosody *prosody) {
    size_t before = piece->tokens.count;
    fe_tokens_add(&piece->tokens, &piece->voice->language, span, text, spell);
    piece->prosody =
        mem_grow(piece->prosody, &piece->prosody_cap, piece->tokens.count, sizeof *piece->prosody);
    for (size_t i = before; i < piece->tokens.count; i++)
        piece->prosody[i] = *prosody;
}

void fe_piece_mark(struct fe_piece *piece, const char *name) {
    piece->marks = mem_grow(piece->marks, &piece->mark_cap, piece->mark_count + 1, sizeof *piece->marks);
    piece->marks[piece->mark_count++] = (struct fe_mark){name, piece->tokens.count};
}

size_t fe_piece_cut(const struct fe_piece *piece, size_t from, size_t max) {
    size_t left = piece->tokens.count - from;
    if (left <= max)
        return piece->tokens.count;
    for (size_t i = from + max; i > from + max / 2; i--)
        if (*piece->tokens.list[i - 1].after)
            return i;
    return from + max;
}

/* Adds a Scheme string. */
static void add_string(struct buf *b, const char *s) {
    buf_add(b, "\"", 1);
    for (; *s; s++) {
        if (*s == '"' || *s == '\\')
            buf_add(b, "\\", 1);
        buf_add(b, s, 1);
    }
    buf_add(b, "\" ", 2);
}

static void add_token(struct buf *b, const struct fe_token *t, size_t index, const struct fe_prosody *p) {
    buf_printf(b, "(");
    add_string(b, t->word);
    add_string(b, t->before);
    add_string(b, t->after);
    buf_printf(b, "%zu %.3f %.3f %.3f)\n", index, p->stretch, p->pitch, p->range);
}

/* Festival's HTS engine accepts one rate per utterance, here the mean, and no pitch. */
static void add_hts(const struct fe_piece *piece, size_t from, size_t to, struct buf *b) {
    double stretch = 0;
    for (size_t i = from; i < to; i++)
        stretch += piece->prosody[i].stretch / (double)(to - from);
    buf_printf(b, "'((\"-r\" %.3f)) ", 1 / stretch);
}

void fe_piece_request(const struct fe_piece *piece, size_t from, size_t to, bool plain, double lead,
                      double trail, struct buf *request) {
    buf_printf(request, "(faccia.speak 'voice_%s %.3f %.3f %.3f ", piece->voice->festival,
               piece->voice->units, lead, trail);
    if (piece->voice->hts)
        add_hts(piece, from, to, request);
    else
        buf_printf(request, "nil ");
    buf_printf(request, "'(\n");
    for (size_t i = from; i < to; i++) {
        struct fe_tokens parts = {0};
        if (plain)
            fe_tokens_add_plain(&parts, &piece->tokens.list[i]);
        else
            add_token(request, &piece->tokens.list[i], i, &piece->prosody[i]);
        for (size_t k = 0; k < parts.count; k++)
            add_token(request, &parts.list[k], i, &piece->prosody[i]);
        fe_tokens_free(&parts);
    }
    buf_printf(request, "))\n");
}

static bool take_phone(struct fe_piece *piece, const char *line) {
    struct fe_said_phone p;
    if (sscanf(line, "p %15s %lf %lf %u", p.name, &p.start, &p.end, &p.stress) != 4)
        return false;
    piece->phones = mem_grow(piece->phones, &piece->phone_cap, piece->phone_count + 1, sizeof *piece->phones);
    piece->phones[piece->phone_count++] = p;
    return true;
}

static bool take_word(struct fe_piece *piece, const char *line) {
    struct fe_said_word w;
    if (sscanf(line, "w %zu %lf %lf", &w.token, &w.start, &w.end) != 3)
        return false;
    struct fe_said_word *last = piece->word_count ? &piece->words[piece->word_count - 1] : NULL;
    if (w.token >= piece->tokens.count || (last && w.token < last->token))
        return true;
    if (last && last->token == w.token) { /* a number has several words */
        last->end = w.end;
        return true;
    }
    piece->words = mem_grow(piece->words, &piece->word_cap, piece->word_count + 1, sizeof *piece->words);
    piece->words[piece->word_count++] = w;
    return true;
}

static enum fe_result take_audio(struct fe_piece *piece, struct fe_child *child, const char *line) {
    double count, rate;
    const void *bytes;
    if (sscanf(line, "a %lf %lf", &count, &rate) != 2 || rate < 8000 || rate > 192000 || count < 0 ||
        count > rate * AUDIO_SECONDS_MAX)
        return FE_DIED;
    enum fe_result result = fe_child_bytes(child, (size_t)count * sizeof *piece->samples, &bytes);
    piece->samples = bytes;
    piece->sample_count = (size_t)count;
    piece->sample_rate = (uint32_t)rate;
    return result;
}

enum fe_result fe_piece_answer(struct fe_piece *piece, struct fe_child *child, bool *refused) {
    const char *line;
    *refused = false;
    piece->phone_count = piece->word_count = 0;
    for (;;) {
        enum fe_result result = fe_child_line(child, &line);
        if (result != FE_OK)
            return result;
        if (*line == 'a')
            return take_audio(piece, child, line);
        *refused = !strcmp(line, "e");
        if (*refused)
            return FE_OK;
        if (!take_phone(piece, line) && !take_word(piece, line))
            return FE_DIED; /* unexpected answer */
    }
}

static uint64_t sample_of(const struct fe_piece *piece, double seconds) {
    double sample = seconds * piece->sample_rate;
    return piece->at + (sample <= 0 ? 0 : (uint64_t)fmin(sample + 0.5, (double)piece->sample_count));
}

static int give_phones(const struct fe_piece *piece) {
    const struct faccia_sink *sink = piece->sink;
    int stop = 0;
    for (size_t i = 0; i < piece->phone_count && !stop; i++) {
        const struct fe_said_phone *p = &piece->phones[i];
        const char *ipa = json_string_value(json_object_get(piece->voice->language.phones, p->name));
        struct faccia_phone phone = {ipa ? ipa : p->name, p->name, sample_of(piece, p->start),
                                     sample_of(piece, p->end), p->stress ? 2 : 0};
        if (i + 1 == piece->phone_count)
            phone.end = piece->at + piece->sample_count;
        stop = sink->phone(sink->ctx, &phone);
    }
    return stop;
}

static int give_words(const struct fe_piece *piece) {
    const struct faccia_sink *sink = piece->sink;
    int stop = 0;
    for (size_t i = 0; i < piece->word_count && !stop; i++) {
        const struct fe_token *t = &piece->tokens.list[piece->words[i].token];
        const struct faccia_word word = {t->span, t->offset, t->bytes,
                                         sample_of(piece, piece->words[i].start),
                                         sample_of(piece, piece->words[i].end)};
        stop = sink->word(sink->ctx, &word);
    }
    return stop;
}

/* Delivers the marks before the tokens up to `to`, each at the start of the next word. */
static int give_marks(struct fe_piece *piece, size_t to) {
    size_t word = 0;
    int stop = 0;
    for (; piece->marks_given < piece->mark_count && !stop; piece->marks_given++) {
        const struct fe_mark *mark = &piece->marks[piece->marks_given];
        while (word < piece->word_count && piece->words[word].token < mark->token)
            word++;
        if (mark->token >= to)
            break;
        uint64_t at = word < piece->word_count ? sample_of(piece, piece->words[word].start)
                                               : piece->at + piece->sample_count;
        stop = piece->sink->mark(piece->sink->ctx, mark->name, at);
    }
    return stop;
}

/* The samples stay in the child's buffer until the next answer. */
static int give_audio(struct fe_piece *piece) {
    int16_t *samples = (int16_t *)piece->samples;
    size_t done = 0;
    double now = piece->word_count ? piece->prosody[piece->words[0].token].volume : 1;
    for (size_t i = 0; i <= piece->word_count; i++) {
        bool last = i + 1 >= piece->word_count;
        size_t end =
            last ? piece->sample_count : (size_t)(sample_of(piece, piece->words[i + 1].start) - piece->at);
        double volume = i < piece->word_count ? piece->prosody[piece->words[i].token].volume : 1;
        if (end > done) {
            fe_amplify(samples, done, end, piece->sample_rate, piece->voice->gain, volume, &now);
            done = end;
        }
    }
    return piece->sink->audio(piece->sink->ctx, samples, piece->sample_count, piece->sample_rate);
}

bool fe_piece_deliver(struct fe_piece *piece, size_t to) {
    int stop = give_phones(piece) || give_words(piece) || give_marks(piece, to) || give_audio(piece);
    piece->at += piece->sample_count;
    return !stop;
}

bool fe_piece_finish(struct fe_piece *piece, double seconds) {
    static const int16_t silence[4096];
    const struct faccia_sink *sink = piece->sink;
    int stop = 0;
    for (; piece->marks_given < piece->mark_count && !stop; piece->marks_given++)
        stop = sink->mark(sink->ctx, piece->marks[piece->marks_given].name, piece->at);
    size_t left = seconds > 0 ? (size_t)(seconds * piece->sample_rate) : 0;
    for (size_t part; left && !stop; left -= part) {
        part = left < sizeof silence / sizeof *silence ? left : sizeof silence / sizeof *silence;
        stop = sink->audio(sink->ctx, silence, part, piece->sample_rate);
        piece->at += part;
    }
    piece->tokens.count = piece->mark_count = piece->marks_given = 0;
    return !stop;
}
