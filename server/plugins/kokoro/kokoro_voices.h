/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voices: a file each, of a style for every number of tokens. Its name tells the language by its first
 * letter and the gender by its second ("if_sara"); kokoro.json says what the letters mean and how a language
 * is read. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_VOICES_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_VOICES_H

#include "server/plugins/kokoro/kokoro_model.h"
#include "server/plugins/kokoro/kokoro_tokens.h"
#include "server/voice/faccia-voice.h"

/* Words per minute: mean of six voices in three languages (133 to 164), measured over a paragraph of each. */
enum { KO_WORDS_PER_MINUTE = 145 };

struct ko_voice {
    char id[40], name[40];
    char *file;
    const char *espeak; /* what espeak-ng calls the language */
    double gain;        /* makes the voices equally loud */
    struct ko_alphabet alphabet;
    struct faccia_voice_info info;
};

struct ko_voices {
    struct ko_voice *list; /* by id */
    size_t count, cap;
    json_t *table, *vocabulary;
};

/* table: kokoro.json; vocabulary: the model's tokenizer.json; folder: of the voices' files. Returns 0, or -1
 * with a sentence in message. */
int ko_voices_load(struct ko_voices *voices, const char *table, const char *vocabulary, const char *folder,
                   char *message, size_t cap);
void ko_voices_free(struct ko_voices *voices);
const struct ko_voice *ko_voices_find(const struct ko_voices *voices, const char *id);

/* Reads the style for that many tokens, without the ends. */
bool ko_voice_style(const struct ko_voice *voice, size_t tokens, float style[KO_STYLE], char *message,
                    size_t cap);

#endif
