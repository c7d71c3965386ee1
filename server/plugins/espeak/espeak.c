/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/common/espeak_text.h"
#include "server/plugins/common/espeak_voices.h"
#include "server/plugins/espeak/espeak_timing.h"
#include "server/voice/faccia-voice.h"
#include <espeak-ng/speak_lib.h>
#include <jansson.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Loads the voices. "variants": espeak-ng's voice variants offered for every language. */
static void es_config_voices(struct es_voices *voices, const char *config) {
    static const char *const usual[] = {"f2"};
    json_t *root = json_loads(config, 0, NULL), *variants = json_object_get(root, "variants"), *variant;
    size_t count = json_array_size(variants), i;
    const char **names = mem_alloc(count * sizeof *names);
    json_array_foreach(variants, i, variant) names[i] =
        json_is_string(variant) ? json_string_value(variant) : "";
    if (json_is_array(variants))
        es_voices_load(voices, names, count);
    else
        es_voices_load(voices, usual, sizeof usual / sizeof *usual);
    free(names);
    json_decref(root);
}

/* Returns the spans for the engine, without those up to a break before the first text or after the last. */
static struct faccia_sentence es_inner_part(const struct faccia_sentence *sentence) {
    const struct faccia_span *spans = sentence->spans;
    size_t begin = 0, end = 0, text = 0, last = 0;
    while (text < sentence->span_count && spans[text].kind != FACCIA_SPAN_TEXT)
        text++;
    for (size_t i = 0; i < sentence->span_count; i++) {
        if (spans[i].kind == FACCIA_SPAN_BREAK && i < text)
            begin = i + 1;
        if (spans[i].kind == FACCIA_SPAN_TEXT)
            last = i;
    }
    if (text == sentence->span_count)
        return (struct faccia_sentence){.voice = sentence->voice, .spans = spans + text};
    for (end = last + 1; end < sentence->span_count && spans[end].kind != FACCIA_SPAN_BREAK;)
        end++;
    return (struct faccia_sentence){
        .voice = sentence->voice, .spans = spans + begin, .span_count = end - begin};
}

/* The espeak-ng voice plugin. libespeak-ng and its callbacks use globals, so there is one instance per
 * process. */

/* Block size of the engine's audio, ms. The engine drops events beyond 200 per second of a block, so it
 * must not be short. */
enum { BLOCK_MS = 500 };

struct espeak {
    struct es_voices voices;
    const struct es_voice *voice; /* current voice */
    struct es_names names;        /* of that voice */
    struct es_ipa ipa;            /* its phones, filled on demand */
    uint32_t sample_rate;
    atomic_bool cancelled;
    /* of the current sentence */
    const struct faccia_sentence *sentence; /* without breaks at its ends */
    uint32_t first_span;                    /* index of its first in the whole sentence */
    uint32_t lead;                          /* samples of silence before it */
    const struct faccia_sink *sink;
    bool stopped; /* by the sink or by cancel */
    int16_t *pcm;
    size_t pcm_count, pcm_cap;
    struct es_phones phones;
    struct es_words words;
    size_t clause; /* first phone of the current clause */
    char *transcription;
    FILE *nowhere; /* the engine cannot transcribe without printing */
};

/* A clause's phones are complete when the next transcription comes, and at the end. */
static void end_clause(struct espeak *self) {
    if (self->transcription)
        es_align(self->phones.list + self->clause, self->phones.count - self->clause, self->transcription,
                 &self->names);
    free(self->transcription);
    self->transcription = NULL;
    self->clause = self->phones.count;
}

static struct espeak *speaking; /* espeak_SetPhonemeCallback takes no context */

static int take_transcription(const char *phonemes) {
    end_clause(speaking);
    speaking->transcription = mem_strdup(phonemes);
    return 0;
}

static void take_event(struct espeak *self, const espeak_EVENT *event) {
    uint32_t sample = self->lead + (event->sample > 0 ? (uint32_t)event->sample : 0);
    if (event->type == espeakEVENT_PHONEME && *event->id.string != '(') { /* "(fr)": a language change */
        struct es_phone *p = es_phones_add(&self->phones);
        memcpy(p->symbol, event->id.string, sizeof event->id.string);
        p->start = sample;
        p->pause = *p->symbol == '_';
    } else if (event->type == espeakEVENT_WORD && event->text_position > 0) {
        struct es_words *words = &self->words;
        words->list = mem_grow(words->list, &words->cap, words->count + 1, sizeof *words->list);
        words->list[words->count++] = (struct es_word){
            .start = sample, .position = (size_t)event->text_position - 1, .empty = event->length == 0};
    } else if (event->type == espeakEVENT_MARK && event->id.name) {
        size_t span = strtoul(event->id.name, NULL, 10);
        if (span < self->sentence->span_count && self->sentence->spans[span].kind == FACCIA_SPAN_MARK)
            self->stopped |= self->sink->mark(self->sink->ctx, self->sentence->spans[span].text, sample) != 0;
    }
}

static void pass_on(struct espeak *self, const int16_t *samples, size_t count) {
    self->pcm = mem_grow(self->pcm, &self->pcm_cap, self->pcm_count + count, sizeof *self->pcm);
    memcpy(self->pcm + self->pcm_count, samples, count * sizeof *samples);
    self->pcm_count += count;
    self->stopped |= self->sink->audio(self->sink->ctx, samples, count, self->sample_rate) != 0;
}

/* Returns 1 to stop. */
static int take_audio(short *samples, int count, espeak_EVENT *events) {
    struct espeak *self = events->user_data;
    if (samples && count > 0)
        pass_on(self, samples, (size_t)count);
    for (; events->type != espeakEVENT_LIST_TERMINATED; events++)
        take_event(self, events);
    self->stopped |= atomic_load(&self->cancelled);
    return self->stopped;
}

static void set_voice(struct espeak *self, const struct es_voice *voice) {
    if (self->voice == voice)
        return;
    espeak_SetVoiceByName(voice->file);
    self->voice = voice;
    self->names = (struct es_names){0};
    es_ipa_free(&self->ipa);
}

static void set_prosody(const struct es_prosody *prosody) {
    espeak_SetParameter(espeakRATE, prosody->rate, 0);
    espeak_SetParameter(espeakPITCH, prosody->pitch, 0);
    espeak_SetParameter(espeakRANGE, prosody->range, 0);
    espeak_SetParameter(espeakVOLUME, prosody->volume, 0);
}

static void complete_words(struct espeak *self) {
    const struct es_phones *phones = &self->phones;
    uint32_t *starts = mem_alloc((phones->count + 1) * sizeof *starts), end = 0;
    for (size_t i = 0; i < phones->count; i++) {
        starts[i] = phones->list[i].start;
        end = phones->list[i].pause ? end : phones->list[i].end;
    }
    es_words_complete(&self->words, self->sentence, starts, phones->count, end);
    free(starts);
}

static void report(struct espeak *self, const struct es_text *text) {
    const struct faccia_sink *sink = self->sink;
    const struct es_audio audio = {self->pcm, (uint32_t)self->pcm_count, self->sample_rate};
    uint32_t *starts = mem_alloc(self->words.count * sizeof *starts);
    for (size_t i = 0; i < self->words.count; i++)
        starts[i] = self->words.list[i].start;
    es_time(&self->phones, &audio, starts, self->words.count);
    free(starts);
    es_words_locate(&self->words, text, self->sentence);
    complete_words(self);
    for (size_t i = 0; i < self->phones.count && !self->stopped; i++) {
        const struct es_phone *p = &self->phones.list[i];
        const struct faccia_phone phone = {p->pause ? "" : p->ipa, p->symbol, p->start, p->end, p->stress};
        self->stopped = sink->phone(sink->ctx, &phone) != 0;
    }
    for (size_t i = 0; i < self->words.count && !self->stopped; i++) {
        const struct es_word *w = &self->words.list[i];
        const struct faccia_word word = {self->first_span + w->span, w->offset, w->bytes, w->start, 0};
        if (w->bytes)
            self->stopped = sink->word(sink->ctx, &word) != 0;
    }
}

static void warn(void *ctx, const char *message) {
    const struct faccia_sink *sink = ctx;
    sink->warning(sink->ctx, message);
}

/* Breaks at the ends of a sentence, which the engine would drop. */
static void speak_silence(struct espeak *self, const struct faccia_span *spans, size_t count) {
    static const int16_t silence[4096];
    for (size_t i = 0; i < count && !self->stopped; i++) {
        double seconds = spans[i].kind == FACCIA_SPAN_BREAK && spans[i].seconds > 0 ? spans[i].seconds : 0;
        size_t left = (size_t)(fmin(seconds, ES_BREAK_MAX) * self->sample_rate), part;
        if (spans[i].kind == FACCIA_SPAN_MARK)
            self->stopped |= self->sink->mark(self->sink->ctx, spans[i].text, self->pcm_count) != 0;
        for (; left && !self->stopped; left -= part) {
            part = left < sizeof silence / sizeof *silence ? left : sizeof silence / sizeof *silence;
            pass_on(self, silence, part);
            self->stopped |= atomic_load(&self->cancelled);
        }
    }
}

/* Runs once per voice and discards the engine's output. */
static void learn_phones(struct espeak *self) {
    if (!es_ipa_learn(&self->ipa, self->sentence, self))
        return;
    free(self->transcription);
    self->transcription = NULL;
    self->phones.count = self->words.count = 0;
}

/* Synthesises the inner part and reports it. */
static espeak_ERROR speak_text(struct espeak *self, const struct es_voice *voice) {
    struct es_text text;
    set_voice(self, voice);
    learn_phones(self);
    es_text_make(&text, self->sentence, voice, &self->voices, &self->ipa, warn, (void *)self->sink);
    set_prosody(&text.prosody);
    unsigned flags =
        espeakCHARS_UTF8 | espeakENDPAUSE | (text.ssml ? espeakSSML : 0) | (text.phones ? espeakPHONEMES : 0);
    espeak_ERROR result =
        espeak_Synth(text.text.data, text.text.size, 0, POS_CHARACTER, 0, flags, NULL, self);
    end_clause(self);
    if (!self->stopped && result == EE_OK)
        report(self, &text);
    es_text_free(&text);
    return result;
}

static int es_speak(void *ctx, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                    char *message, size_t cap) {
    struct espeak *self = ctx;
    const struct es_voice *voice = es_voices_find(&self->voices, sentence->voice);
    const struct faccia_sentence inner = es_inner_part(sentence);
    size_t first = (size_t)(inner.spans - sentence->spans), rest = first + inner.span_count;
    espeak_ERROR result = EE_OK;
    if (!voice) {
        snprintf(message, cap, "espeak-ng has no voice \"%s\"", sentence->voice);
        return -1;
    }
    atomic_store(&self->cancelled, false);
    self->sentence = &inner;
    self->first_span = (uint32_t)first;
    self->sink = sink;
    self->stopped = false;
    self->pcm_count = self->phones.count = self->words.count = self->clause = 0;
    speak_silence(self, sentence->spans, first);
    self->lead = (uint32_t)self->pcm_count;
    if (inner.span_count && !self->stopped)
        result = speak_text(self, voice);
    if (result != EE_OK && !self->stopped) {
        snprintf(message, cap, "espeak-ng answered with error %d", (int)result);
        return -1;
    }
    speak_silence(self, sentence->spans + rest, sentence->span_count - rest);
    return 0;
}

static void es_cancel(void *ctx) {
    struct espeak *self = ctx;
    atomic_store(&self->cancelled, true);
}

static void es_list(void *ctx, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                    void *each_ctx) {
    const struct espeak *self = ctx;
    for (size_t i = 0; i < self->voices.count; i++) {
        const struct es_voice *v = &self->voices.list[i];
        const struct faccia_voice_info info = {.id = v->id,
                                               .name = v->name,
                                               .lang = v->lang,
                                               .gender = v->gender,
                                               .quality = "formant",
                                               .licence = "GPL-3.0-or-later",
                                               .sample_rate = self->sample_rate,
                                               .rate = ES_RATE_OWN};
        each(each_ctx, &info);
    }
}

static void es_close(void *ctx) {
    struct espeak *self = ctx;
    espeak_Terminate();
    if (self->nowhere)
        fclose(self->nowhere);
    es_voices_free(&self->voices);
    es_ipa_free(&self->ipa);
    free(self->pcm);
    free(self->phones.list);
    free(self->words.list);
    free(self);
    speaking = NULL;
}

static int es_open(const char *config, void **out, char *message, size_t cap) {
    int rate = espeak_Initialize(AUDIO_OUTPUT_SYNCHRONOUS, BLOCK_MS, NULL,
                                 espeakINITIALIZE_PHONEME_EVENTS | espeakINITIALIZE_DONT_EXIT);
    if (rate <= 0) {
        snprintf(message, cap, "espeak-ng cannot read its data");
        return -1;
    }
    struct espeak *self = mem_alloc(sizeof *self);
    self->sample_rate = (uint32_t)rate;
    self->nowhere = fopen("/dev/null", "w");
    es_config_voices(&self->voices, config);
    if (!self->voices.count || !self->nowhere) {
        snprintf(message, cap, self->nowhere ? "espeak-ng has no voices" : "/dev/null cannot be opened");
        es_close(self);
        return -1;
    }
    speaking = self;
    espeak_SetSynthCallback(take_audio);
    espeak_SetPhonemeCallback(take_transcription);
    espeak_SetPhonemeTrace(espeakPHONEMES_IPA | ES_SEPARATOR << 8, self->nowhere);
    const struct es_prosody normal = {ES_RATE_OWN, 50, 50, 100};
    set_voice(self, &self->voices.list[0]); /* the first call is expensive: make it now */
    set_prosody(&normal);
    *out = self;
    return 0;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "espeak",
    .version = FACCIA_VERSION,
    .licence = "GPL-3.0-or-later",
    .capabilities = FACCIA_VOICE_STREAMS | FACCIA_VOICE_MARKS | FACCIA_VOICE_RATE | FACCIA_VOICE_PITCH |
                    FACCIA_VOICE_RANGE | FACCIA_VOICE_VOLUME | FACCIA_VOICE_PHONEMES,
    .open = es_open,
    .list = es_list,
    .speak = es_speak,
    .cancel = es_cancel,
    .close = es_close,
};
