/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads sound files of any length and any format of libsndfile (WAV, FLAC, Ogg, MP3 if built in), and
 * read-aloud books (book_sound.h), as 16-bit mono. */
#ifndef FACCIA_LIBRARY_ALIGN_SOUND_FILE_H
#define FACCIA_LIBRARY_ALIGN_SOUND_FILE_H

#include "server/base/error.h"
#include <stdbool.h>
#include <stdint.h>

/* A random-access sound: reads up to count samples from a position, fewer at the end. */
struct sound_source {
    size_t (*read)(void *ctx, uint64_t from, int16_t *out, size_t count);
    void *ctx;
    uint32_t rate;    /* Hz */
    uint64_t samples; /* total */
};

struct sound_file;

/* NULL with *e ("bad-sound"). */
struct sound_file *sound_open(const char *path, struct error *e);
void sound_close(struct sound_file *sound);

/* Valid while the file is open. */
const struct sound_source *sound_source(const struct sound_file *sound);

/* A part of the sound, and the text that it reads. */
struct sound_clip {
    uint64_t from, to; /* samples */
    char *text;
    bool open; /* to the end of the file, without an end of its own: what follows the text may be read there,
                  too */
};

/* The clips of a read-aloud book that name their text, in order. Returns how many; others have none. Free
 * them. */
size_t sound_clips(struct sound_file *sound, struct sound_clip **clips);
void sound_clips_free(struct sound_clip *clips, size_t count);

/* Sound in memory, as a source. */
struct sound_memory {
    const int16_t *pcm;
    size_t samples;
};
struct sound_source sound_in_memory(struct sound_memory *memory, uint32_t rate);

#endif
