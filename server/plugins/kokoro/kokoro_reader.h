/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From text to tokens: espeak-ng reads the text, as it did when Kokoro was taught, and tells which phones
 * each word has. Its own sound is thrown away. It keeps its state in globals: one reader in a process. */
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
    struct ko_items items; /* ends with a stop, unless it is empty */
    struct ko_word *words;
    size_t word_count, word_cap;
};

struct ko_reader;

/* NULL with a sentence in message. */
struct ko_reader *ko_reader_open(char *message, size_t cap);
void ko_reader_close(struct ko_reader *reader);

/* The voice of espeak-ng that reads for a language ("pt-br"), NULL = there is none. */
const struct es_voice *ko_reader_voice(const struct ko_reader *reader, const char *id);

/* Reads the spans [from, to) of a sentence, none of them a break. Their prosody does not matter here. False
 * when espeak-ng fails. */
bool ko_read(struct ko_reader *reader, const struct es_voice *voice, const struct ko_alphabet *alphabet,
             const struct faccia_sentence *sentence, size_t from, size_t to, struct ko_text *text,
             void (*warn)(void *ctx, const char *message), void *ctx);
void ko_text_free(struct ko_text *text);

#endif
