/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts text to tokens: espeak-ng reads the text, as in Kokoro's training, and reports each word's
 * phones; its sound is discarded. It uses globals, so there is one reader per process. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_READER_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_READER_H

#include "server/plugins/common/espeak_voices.h"
#include "server/plugins/kokoro/kokoro_tokens.h"
#include "server/voice/faccia-voice.h"

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

#endif
