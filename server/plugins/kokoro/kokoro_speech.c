/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/kokoro/kokoro_internal.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Range of speeds that sound acceptable. */
#define SPEED_MIN 0.5
#define SPEED_MAX 2.0

/* Words whose rates differ by less than this factor share a piece. */
#define SPEED_STEP 1.08

#define BREAK_MAX 600.0

/* Seconds of silence added after a piece: at a comma, at a sentence's end, at the very end. */
#define COMMA 0.12
#define PERIOD 0.3
#define TRAIL 0.25

/* Rate of volume changes: fraction of the difference per sample. */
#define GAIN_STEP 0.01

struct speaking {
    struct ko_speaker *speaker;
    const struct ko_voice *voice;
    const struct faccia_sentence *sentence;
    const struct faccia_sink *sink;
    uint64_t at;    /* samples delivered */
    uint32_t told;  /* words of this text delivered */
    uint64_t pause; /* end of the last phone delivered */
    double gain;    /* of the last sample */
    bool stopped;
    char *message;
    size_t cap;
};

static double speed_of(const struct speaking *s, uint32_t word) {
    const struct faccia_span *span = &s->sentence->spans[s->speaker->text.words[word].span];
    double speed = span->rate > 0 ? span->rate / s->voice->info.rate : 1;
    return fmin(fmax(speed, SPEED_MIN), SPEED_MAX);
}

static double gain_of(const struct speaking *s, uint32_t word) {
    const struct faccia_span *span = &s->sentence->spans[s->speaker->text.words[word].span];
    return span->volume >= 0 ? span->volume : 1;
}

static bool changes(void *ctx, uint32_t a, uint32_t b) {
    const struct speaking *s = ctx;
    double ratio = a == b ? 1 : speed_of(s, a) / speed_of(s, b);
    return ratio > SPEED_STEP || ratio * SPEED_STEP < 1;
}

static void warn(void *ctx, const char *message) {
    const struct faccia_sink *sink = ctx;
    sink->warning(sink->ctx, message);
}

static void hand_on(struct speaking *s, const int16_t *samples, size_t count) {
    s->stopped |=
        s->sink->audio(s->sink->ctx, samples, count, KO_RATE) != 0 || atomic_load(&s->speaker->cancelled);
    s->at += count;
}

/* Delivers a phone. Pauses are held back until a phone follows, so that adjacent ones merge. */
static void hand_on_phone(struct speaking *s, const struct ko_item *item, uint64_t start, uint64_t end) {
    const struct faccia_phone pause = {"", "_", s->pause, start, 0};
    if (end <= start)
        return;
    if (item && start > s->pause && !s->stopped)
        s->stopped = s->sink->phone(s->sink->ctx, &pause) != 0;
    if (!item)
        return;
    const struct faccia_phone phone = {item->ipa, item->ipa, start, end, item->stress};
    if (!s->stopped)
        s->stopped = s->sink->phone(s->sink->ctx, &phone) != 0;
    s->pause = end;
}

static void end_pause(struct speaking *s) {
    const struct faccia_phone pause = {"", "_", s->pause, s->at, 0};
    if (s->at > s->pause && !s->stopped)
        s->stopped = s->sink->phone(s->sink->ctx, &pause) != 0;
}

static void silence(struct speaking *s, double seconds) {
    static const int16_t zeros[4096];
    size_t left = (size_t)(fmin(fmax(seconds, 0), BREAK_MAX) * KO_RATE), part;
    for (; left && !s->stopped; left -= part) {
        part = left < sizeof zeros / sizeof *zeros ? left : sizeof zeros / sizeof *zeros;
        hand_on(s, zeros, part);
    }
}

/* Delivers the words that begin in the piece. */
static void hand_on_words(struct speaking *s) {
    const struct ko_timing *t = &s->speaker->timing;
    const struct ko_text *text = &s->speaker->text;
    for (size_t i = 0; i < t->count && !s->stopped; i++) {
        if (t->list[i].item == SIZE_MAX || text->items.list[t->list[i].item].word < s->told)
            continue;
        uint32_t index = text->items.list[t->list[i].item].word, end = t->list[i].end;
        for (size_t k = i + 1; k < t->count; k++)
            if (t->list[k].item != SIZE_MAX && text->items.list[t->list[k].item].word == index)
                end = t->list[k].end;
        const struct ko_word *w = &text->words[index];
        const struct faccia_word word = {w->span, w->offset, w->bytes, s->at + t->list[i].start, s->at + end};
        s->stopped = s->sink->word(s->sink->ctx, &word) != 0;
        s->told = index + 1;
    }
}

/* Applies the volume of each word's span. */
static void amplify(struct speaking *s, int16_t *samples) {
    const struct ko_timing *t = &s->speaker->timing;
    double wanted = s->gain;
    for (size_t i = 0; i < t->count; i++) {
        if (t->list[i].item != SIZE_MAX)
            wanted = gain_of(s, s->speaker->text.items.list[t->list[i].item].word);
        for (uint32_t k = t->list[i].start; k < t->list[i].end; k++) {
            s->gain += (wanted - s->gain) * GAIN_STEP;
            samples[k] = (int16_t)fmin(fmax(round(samples[k] * s->gain), -32767), 32767);
        }
    }
}

/* Returns the silence after the item. */
static double rest_after(const struct speaking *s, size_t item, bool last) {
    const struct ko_items *items = &s->speaker->text.items;
    const json_t *vocabulary = s->voice->alphabet.vocabulary;
    static const char *const strong[] = {".", "!", "?", ";", "\u2026"};
    bool end = last && item + 1 == items->count;
    if (items->list[item].kind != KO_STOP)
        return end ? TRAIL : 0;
    for (size_t i = 0; i < sizeof strong / sizeof *strong; i++)
        for (unsigned k = 0; k < items->list[item].token_count; k++)
            if (items->list[item].tokens[k] == json_integer_value(json_object_get(vocabulary, strong[i])))
                return end ? TRAIL : PERIOD;
    return COMMA; /* also when a long sentence continues in the next request */
}

/* Delivers the sound of the items [from, to) with phones and words. */
static void deliver(struct speaking *s, size_t from, size_t to, struct ko_speech *speech) {
    struct ko_timing *t = &s->speaker->timing;
    const struct ko_item *items = s->speaker->text.items.list;
    ko_time(t, items + from, to - from, speech->durations, speech->samples, speech->sample_count);
    for (size_t i = 0; i < t->count; i++)
        t->list[i].item += t->list[i].item == SIZE_MAX ? 0 : from;
    amplify(s, speech->samples + t->from);
    for (size_t i = 0; i < t->count; i++) {
        const struct ko_item *item = t->list[i].item == SIZE_MAX ? NULL : &items[t->list[i].item];
        hand_on_phone(s, item, s->at + t->list[i].start, s->at + t->list[i].end);
    }
    hand_on_words(s);
    if (!s->stopped)
        hand_on(s, speech->samples + t->from, t->to - t->from);
}

/* Speaks the items [from, to). Returns false with a message on failure. */
static bool speak_piece(struct speaking *s, size_t from, size_t to) {
    const struct ko_items *items = &s->speaker->text.items;
    int64_t tokens[KO_TOKENS_MAX + 2] = {KO_TOKEN_END};
    size_t count = 1;
    float style[KO_STYLE];
    struct ko_speech speech;
    for (size_t i = from; i < to; i++)
        for (unsigned k = 0; k < items->list[i].token_count && count <= KO_TOKENS_MAX; k++)
            tokens[count++] = items->list[i].tokens[k];
    tokens[count++] = KO_TOKEN_END;
    if (!ko_voice_style(s->voice, count - 2, style, s->message, s->cap))
        return false;
    bool ok =
        ko_model_run(s->speaker->model, tokens, count, style, (float)speed_of(s, items->list[from].word),
                     s->voice->gain, &speech, s->message, s->cap);
    if (ok)
        deliver(s, from, to, &speech);
    ko_speech_free(&speech);
    s->stopped |= atomic_load(&s->speaker->cancelled);
    return ok || s->stopped;
}

/* Speaks the spans [from, to), which contain no breaks. last: only silence follows. */
static bool speak_text(struct speaking *s, size_t from, size_t to, bool last) {
    const struct es_voice *reader_voice = ko_reader_voice(s->speaker->reader, s->voice->espeak);
    struct ko_text *text = &s->speaker->text;
    if (!reader_voice) {
        snprintf(s->message, s->cap, "espeak-ng, which reads the text, has no voice \"%s\"",
                 s->voice->espeak);
        return false;
    }
    if (!ko_read(s->speaker->reader, reader_voice, &s->voice->alphabet, s->sentence, from, to, text, warn,
                 (void *)s->sink)) {
        snprintf(s->message, s->cap, "espeak-ng cannot read the text");
        return false;
    }
    s->told = 0;
    for (size_t begin = 0, end; begin < text->items.count && !s->stopped; begin = end) {
        end = ko_cut(&text->items, begin, changes, s);
        if (!speak_piece(s, begin, end))
            return false;
        silence(s, rest_after(s, end - 1, last));
    }
    return true;
}

static bool has_text(const struct faccia_sentence *sentence, size_t from) {
    while (from < sentence->span_count && sentence->spans[from].kind != FACCIA_SPAN_TEXT)
        from++;
    return from < sentence->span_count;
}

static bool is_slow_or_fast(const struct faccia_sentence *sentence, double own) {
    for (size_t i = 0; i < sentence->span_count; i++) {
        double speed = sentence->spans[i].rate > 0 ? sentence->spans[i].rate / own : 1;
        if (sentence->spans[i].kind == FACCIA_SPAN_TEXT && (speed < SPEED_MIN || speed > SPEED_MAX))
            return true;
    }
    return false;
}

bool ko_speaker_speak(struct ko_speaker *speaker, const struct ko_voice *voice,
                      const struct faccia_sentence *sentence, const struct faccia_sink *sink, char *message,
                      size_t cap) {
    struct speaking s = {.speaker = speaker, .voice = voice, .sentence = sentence, .sink = sink, .gain = 1};
    s.message = message;
    s.cap = cap;
    atomic_store(&speaker->cancelled, false);
    ko_model_resume(speaker->model);
    if (is_slow_or_fast(sentence, voice->info.rate))
        warn((void *)sink, "the voice's rate is limited to half to twice its own");
    for (size_t i = 0, end; i < sentence->span_count && !s.stopped; i = end) {
        const struct faccia_span *spans = sentence->spans;
        for (end = i; end < sentence->span_count && spans[end].kind != FACCIA_SPAN_BREAK;)
            end++;
        if (end > i && !speak_text(&s, i, end, !has_text(sentence, end)))
            return false;
        if (end < sentence->span_count)
            silence(&s, spans[end++].seconds);
    }
    end_pause(&s);
    return true;
}

void ko_speaker_set_model(struct ko_speaker *speaker, struct ko_model *model) {
    atomic_store(&speaker->model, model);
}

/* A cancel between sentences has no effect: the next sentence resumes. */
void ko_speaker_cancel(struct ko_speaker *speaker) {
    struct ko_model *model = atomic_load(&speaker->model);
    atomic_store(&speaker->cancelled, true);
    if (model)
        ko_model_stop(model);
}

void ko_speaker_free(struct ko_speaker *speaker) {
    ko_model_free(speaker->model);
    ko_reader_close(speaker->reader);
    ko_voices_free(&speaker->voices);
    ko_text_free(&speaker->text);
    free(speaker->timing.list);
}
