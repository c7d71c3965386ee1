/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/encode.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

struct encoder {
    struct encoding encoding;
};

static const struct {
    const char *name;
    int codec;
} audio_names[] = {{"none", CHUNK_AUDIO_SILENCE},
                   {"pcm_s16le", CHUNK_AUDIO_PCM_S16LE},
                   {"pcm", CHUNK_AUDIO_PCM_S16LE}},
  fap_names[] = {{"none", CHUNK_FAP_NONE}, {"plain", CHUNK_FAP_PLAIN}};

const struct encoding encoding_default = {CHUNK_AUDIO_PCM_S16LE, CHUNK_FAP_PLAIN};

int encoding_audio(const char *name) {
    for (size_t i = 0; i < sizeof audio_names / sizeof *audio_names; i++)
        if (!strcmp(audio_names[i].name, name))
            return audio_names[i].codec;
    return -1;
}

int encoding_fap(const char *name) {
    for (size_t i = 0; i < sizeof fap_names / sizeof *fap_names; i++)
        if (!strcmp(fap_names[i].name, name))
            return fap_names[i].codec;
    return -1;
}

bool encoding_same(const struct encoding *a, const struct encoding *b) {
    return a->audio == b->audio && a->fap == b->fap;
}

struct encoder *encoder_new(const struct encoding *encoding) {
    struct encoder *encoder = mem_alloc(sizeof *encoder);
    encoder->encoding = *encoding;
    return encoder;
}

void encoder_free(struct encoder *encoder) {
    free(encoder);
}

void encoder_restart(struct encoder *encoder) {
    (void)encoder;
}

bool encoder_chunk(struct encoder *encoder, const struct chunk *chunk, const struct fap_frame *frames,
                   struct buf *out) {
    struct chunk coded = *chunk;
    if (encoder->encoding.audio == CHUNK_AUDIO_SILENCE || chunk->audio_codec == CHUNK_AUDIO_SILENCE) {
        coded.audio_codec = CHUNK_AUDIO_SILENCE;
        coded.audio_bytes = 0;
    }
    if (encoder->encoding.fap == CHUNK_FAP_NONE) {
        coded.fap_codec = CHUNK_FAP_NONE;
        coded.frame_count = 0;
    }
    size_t cap = CHUNK_HEADER_BYTES + coded.audio_bytes + (size_t)coded.frame_count * CHUNK_FRAME_BYTES_MAX;
    out->size += chunk_encode(&coded, frames, buf_reserve(out, cap), cap);
    return true;
}

void encoder_end(struct encoder *encoder, struct buf *out) {
    (void)encoder;
    (void)out;
}
