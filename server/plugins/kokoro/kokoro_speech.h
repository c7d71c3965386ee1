/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speaks a sentence: reads it, cuts it into pieces, synthesises and delivers each. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_SPEECH_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_SPEECH_H

#include "server/plugins/kokoro/kokoro_model.h"
#include "server/plugins/kokoro/kokoro_reader.h"
#include "server/plugins/kokoro/kokoro_timing.h"
#include "server/plugins/kokoro/kokoro_voices.h"
#include <stdatomic.h>

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
