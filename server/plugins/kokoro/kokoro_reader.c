/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/common/espeak_align.h"
#include "server/plugins/common/espeak_text.h"
#include "server/plugins/kokoro/kokoro_internal.h"
#include <ctype.h>
#include <espeak-ng/speak_lib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The engine drops events beyond 200 per second of a block. */
enum { BLOCK_MS = 500 };

struct ko_reader {
    struct es_voices voices;
    const struct es_voice *voice; /* current voice */
    struct es_names names;        /* of that voice */
    struct es_ipa ipa;            /* its phones, filled on demand */
    FILE *nowhere;                /* the engine cannot transcribe without printing */
    /* of the current text */
    struct es_phone *phones;
    size_t phone_count, phone_cap;
    struct es_words words; /* start: index of the first phone */
    size_t clause;         /* first phone of the current clause */
    char *transcription;
};

static struct ko_reader *reading; /* espeak_SetPhonemeCallback takes no context */

/* A clause's phones are complete when the next transcription comes, and at the end. */
static void end_clause(struct ko_reader *r) {
    if (r->transcription)
        es_align(r->phones + r->clause, r->phone_count - r->clause, r->transcription, &r->names);
    free(r->transcription);
    r->transcription = NULL;
    r->clause = r->phone_count;
}

static int take_transcription(const char *phonemes) {
    end_clause(reading);
    reading->transcription = mem_strdup(phonemes);
    return 0;
}

static void take_event(struct ko_reader *r, const espeak_EVENT *event) {
    if (event->type == espeakEVENT_PHONEME && *event->id.string != '(') { /* "(fr)": a language change */
        r->phones = mem_grow(r->phones, &r->phone_cap, r->phone_count + 1, sizeof *r->phones);
        struct es_phone *p = &r->phones[r->phone_count++];
        *p = (struct es_phone){.pause = *event->id.string == '_'};
        memcpy(p->symbol, event->id.string, sizeof event->id.string);
    } else if (event->type == espeakEVENT_WORD && event->text_position > 0) {
        struct es_words *words = &r->words;
        words->list = mem_grow(words->list, &words->cap, words->count + 1, sizeof *words->list);
        words->list[words->count++] = (struct es_word){.start = (uint32_t)r->phone_count,
                                                       .position = (size_t)event->text_position - 1,
                                                       .empty = event->length == 0};
    }
}

static int take_audio(short *samples, int count, espeak_EVENT *events) {
    struct ko_reader *r = events->user_data;
    (void)samples;
    (void)count;
    for (; events->type != espeakEVENT_LIST_TERMINATED; events++)
        take_event(r, events);
    return 0;
}

static void set_voice(struct ko_reader *r, const struct es_voice *voice) {
    if (r->voice == voice)
        return;
    espeak_SetVoiceByName(voice->file);
    espeak_SetParameter(espeakRATE, ES_RATE_OWN, 0);
    r->voice = voice;
    r->names = (struct es_names){0};
    es_ipa_free(&r->ipa);
}

/* Gets the text between two places of the spans. */
static void between(const struct faccia_sentence *inner, const struct ko_word *a, const struct es_word *b,
                    struct buf *out) {
    uint32_t last = b ? b->span : (uint32_t)inner->span_count - 1;
    for (uint32_t i = a->span; i <= last; i++) {
        const char *s = inner->spans[i].text;
        size_t from = i == a->span ? a->offset + a->bytes : 0, to = b && i == last ? b->offset : strlen(s);
        if (to > from)
            buf_add(out, s + from, to - from);
    }
}

/* espeak-ng reads some words together with the next ("for the") and reports only the first. Extends the
 * word by what has a letter in the rest of the text; returns the bytes added. */
static size_t join(const char *rest, size_t size) {
    size_t end = size;
    while (end && !isalnum((unsigned char)rest[end - 1]))
        end--;
    while (end && end < size && !isspace((unsigned char)rest[end]) && !ispunct((unsigned char)rest[end]))
        end++;
    return end;
}

/* Completes the current word. */
static void end_word(const struct faccia_sentence *inner, const struct ko_alphabet *alphabet,
                     struct ko_text *text, const struct es_word *next) {
    struct buf rest = {0};
    if (!text->items.count)
        return;
    struct ko_word *word = &text->words[text->word_count - 1];
    between(inner, word, next, &rest);
    size_t joined = next && next->span == word->span ? join((const char *)rest.data, rest.size) : 0;
    word->bytes += joined;
    ko_add_between(&text->items, alphabet, rest.size ? (const char *)rest.data + joined : "",
                   rest.size - joined, (uint32_t)text->word_count - 1, !next);
    buf_free(&rest);
}

/* A word counts if it has a speakable phone. */
static void collect(const struct ko_reader *r, const struct faccia_sentence *inner,
                    const struct ko_alphabet *alphabet, struct ko_text *text) {
    const struct es_word *pending = NULL;
    size_t w = 0;
    for (size_t i = 0; i < r->phone_count; i++) {
        const struct es_phone *p = &r->phones[i];
        for (; w < r->words.count && r->words.list[w].start <= i; w++)
            if (r->words.list[w].bytes && r->words.list[w].span < inner->span_count)
                pending = &r->words.list[w];
        if (p->pause || !*p->ipa || (!pending && !text->word_count))
            continue;
        if (pending) {
            end_word(inner, alphabet, text, pending);
            text->words = mem_grow(text->words, &text->word_cap, text->word_count + 1, sizeof *text->words);
            text->words[text->word_count++] =
                (struct ko_word){pending->span, pending->offset, pending->bytes};
            pending = NULL;
        }
        ko_add_phone(&text->items, alphabet, p->ipa, p->stress, (uint32_t)text->word_count - 1);
    }
    end_word(inner, alphabet, text, NULL);
}

/* Returns the spans for espeak-ng, which differ only in language and say-as. */
static struct faccia_span *plain_spans(const struct faccia_sentence *sentence, size_t from, size_t to) {
    struct faccia_span *spans = mem_alloc((to - from) * sizeof *spans);
    for (size_t i = from; i < to; i++) {
        const struct faccia_span *s = &sentence->spans[i];
        spans[i - from] =
            (struct faccia_span){.kind = FACCIA_SPAN_TEXT, .text = "", .pitch = 1, .range = 1, .volume = 1};
        if (s->kind == FACCIA_SPAN_TEXT) {
            spans[i - from].text = s->text;
            spans[i - from].lang = s->lang;
            spans[i - from].say_as = s->say_as;
            spans[i - from].phones = s->phones;
        }
    }
    return spans;
}

bool ko_read(struct ko_reader *r, const struct es_voice *voice, const struct ko_alphabet *alphabet,
             const struct faccia_sentence *sentence, size_t from, size_t to, struct ko_text *text,
             void (*warn)(void *ctx, const char *message), void *ctx) {
    struct faccia_span *spans = plain_spans(sentence, from, to);
    const struct faccia_sentence inner = {.voice = sentence->voice, .spans = spans, .span_count = to - from};
    struct es_text given;
    text->items.count = text->word_count = 0;
    set_voice(r, voice);
    es_ipa_learn(&r->ipa, &inner, r);
    free(r->transcription);
    r->transcription = NULL;
    r->phone_count = r->words.count = r->clause = 0;
    es_text_make(&given, &inner, voice, &r->voices, &r->ipa, warn, ctx);
    unsigned flags = espeakCHARS_UTF8 | (given.ssml ? espeakSSML : 0) | (given.phones ? espeakPHONEMES : 0);
    espeak_ERROR result = espeak_Synth(given.text.data, given.text.size, 0, POS_CHARACTER, 0, flags, NULL, r);
    end_clause(r);
    if (result == EE_OK) {
        es_words_locate(&r->words, &given, &inner);
        collect(r, &inner, alphabet, text);
        for (size_t i = 0; i < text->word_count; i++)
            text->words[i].span += (uint32_t)from;
    }
    es_text_free(&given);
    free(spans);
    return result == EE_OK;
}

void ko_text_free(struct ko_text *text) {
    free(text->items.list);
    free(text->words);
    *text = (struct ko_text){0};
}

const struct es_voice *ko_reader_voice(const struct ko_reader *r, const char *id) {
    return es_voices_find(&r->voices, id);
}

struct ko_reader *ko_reader_open(char *message, size_t cap) {
    if (espeak_Initialize(AUDIO_OUTPUT_SYNCHRONOUS, BLOCK_MS, NULL,
                          espeakINITIALIZE_PHONEME_EVENTS | espeakINITIALIZE_DONT_EXIT) <= 0) {
        snprintf(message, cap, "espeak-ng, which reads the text, cannot read its data");
        return NULL;
    }
    struct ko_reader *r = mem_alloc(sizeof *r);
    es_voices_load(&r->voices, NULL, 0);
    r->nowhere = fopen("/dev/null", "w");
    reading = r;
    espeak_SetSynthCallback(take_audio);
    espeak_SetPhonemeCallback(take_transcription);
    if (r->nowhere) {
        espeak_SetPhonemeTrace(espeakPHONEMES_IPA | ES_SEPARATOR << 8, r->nowhere);
        return r;
    }
    snprintf(message, cap, "/dev/null cannot be opened");
    ko_reader_close(r);
    return NULL;
}

void ko_reader_close(struct ko_reader *r) {
    if (!r)
        return;
    espeak_Terminate();
    if (r->nowhere)
        fclose(r->nowhere);
    es_voices_free(&r->voices);
    es_ipa_free(&r->ipa);
    free(r->transcription);
    free(r->phones);
    free(r->words.list);
    free(r);
    reading = NULL;
}
