/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/sound/mixdown.h"
#include "server/base/sound/wav_file.h"
#include "server/plugins/command/command_internal.h"
#include <math.h>
#include <sndfile.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 4096, CHANNELS_MAX = MIXDOWN_CHANNELS_MAX };

/* A file in memory, for libsndfile. */
struct memory {
    const uint8_t *data;
    sf_count_t size, at;
};

static sf_count_t get_size(void *ctx) {
    return ((struct memory *)ctx)->size;
}

static sf_count_t seek(sf_count_t offset, int whence, void *ctx) {
    struct memory *m = ctx;
    sf_count_t to = offset + (whence == SEEK_CUR ? m->at : whence == SEEK_END ? m->size : 0);
    m->at = to < 0 ? 0 : to > m->size ? m->size : to;
    return m->at;
}

static sf_count_t get(void *out, sf_count_t count, void *ctx) {
    struct memory *m = ctx;
    if (count > m->size - m->at)
        count = m->size - m->at;
    memcpy(out, m->data + m->at, (size_t)count);
    m->at += count;
    return count;
}

static sf_count_t put(const void *data, sf_count_t count, void *ctx) {
    (void)data, (void)count, (void)ctx;
    return 0;
}

static sf_count_t tell(void *ctx) {
    return ((struct memory *)ctx)->at;
}

static void add_frames(struct cm_sound *sound, struct mixdown *mixdown, size_t *cap, const short *frames,
                       size_t count, int channels) {
    float frame[CHANNELS_MAX];
    sound->samples = mem_grow(sound->samples, cap, sound->count + count, sizeof *sound->samples);
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < channels; c++)
            frame[c] = (float)frames[i * (size_t)channels + (size_t)c] / 32768;
        double mono = 32768 * mixdown_frame(mixdown, frame, (unsigned)channels);
        sound->samples[sound->count++] = (int16_t)fmin(32767, lrint(mono));
    }
}

int cm_sound_read(struct cm_sound *sound, void *data, size_t size, uint32_t raw, char *message, size_t cap) {
    struct memory memory = {data, (sf_count_t)size, 0};
    SF_VIRTUAL_IO io = {get_size, seek, get, put, tell};
    SF_INFO info = {0};
    short frames[FRAMES * CHANNELS_MAX];
    struct mixdown mixdown = {0};
    size_t room = 0;
    *sound = (struct cm_sound){.rate = raw};
    if (raw) {
        sound->samples = mem_alloc(size);
        sound->count = size / sizeof *sound->samples;
        if (sound->count)
            memcpy(sound->samples, data, sound->count * sizeof *sound->samples);
        return 0;
    }
    wav_file_mend(data, size); /* programs that write to a pipe cannot fill in the length */
    SNDFILE *file = size ? sf_open_virtual(&io, SFM_READ, &info, &memory) : NULL;
    if (!file || info.channels < 1 || info.channels > CHANNELS_MAX) {
        snprintf(message, cap, "wrote no sound (%zu bytes): %s", size,
                 !size  ? "nothing at all"
                 : file ? "it has too many channels"
                        : sf_strerror(NULL));
        sf_close(file);
        return -1;
    }
    sound->rate = (uint32_t)info.samplerate;
    sf_command(file, SFC_SET_SCALE_FLOAT_INT_READ, NULL, SF_TRUE);
    for (sf_count_t n; (n = sf_readf_short(file, frames, FRAMES)) > 0;)
        add_frames(sound, &mixdown, &room, frames, (size_t)n, info.channels);
    sf_close(file);
    return 0;
}
