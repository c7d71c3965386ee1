/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voices, one file each with a style per number of tokens. The name's first letter is the language,
 * the second the gender ("if_sara"); kokoro.json defines the letters and how languages are read. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_VOICES_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_VOICES_H

#include "server/plugins/kokoro/kokoro_model.h"
#include "server/plugins/kokoro/kokoro_tokens.h"
#include "server/voice/faccia-voice.h"

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

#endif
