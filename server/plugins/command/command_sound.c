/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/sound/memory_file.h"
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
    struct memory_file memory = {.data = data, .size = (sf_count_t)size};
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
    SNDFILE *file = size ? memory_file_open(&memory, &info) : NULL;
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
