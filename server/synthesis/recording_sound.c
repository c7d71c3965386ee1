/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/beneath.h"
#include "server/base/mem.h"
#include "server/base/mixdown.h"
#include "server/base/wav_file.h"
#include "server/synthesis/recording_internal.h"
#include <fcntl.h>
#include <math.h>
#include <sndfile.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RATE_MIN = 8000, RATE_MAX = 192000, CHANNELS_MAX = 8, BLOCK = 4096 };

const char *const recording_sounds[] = {"wav",  "flac", "ogg", "opus", "oga", "mp3",
                                        "aiff", "aif",  "au",  "caf",  "w64", NULL};

struct recording_sound {
    SNDFILE *file;
    SF_INFO info;
    struct mixdown mixdown;
    const struct buf *memory; /* what is read from, when it is no file */
    sf_count_t at;
    float *block; /* BLOCK frames of all channels */
};

static sf_count_t memory_size(void *self) {
    return (sf_count_t)((struct recording_sound *)self)->memory->size;
}

static sf_count_t memory_seek(sf_count_t offset, int whence, void *self) {
    struct recording_sound *s = self;
    sf_count_t from = whence == SEEK_CUR ? s->at : whence == SEEK_END ? memory_size(s) : 0;
    if (offset < -from || offset > memory_size(s) - from)
        return -1;
    return s->at = from + offset;
}

static sf_count_t memory_read(void *to, sf_count_t count, void *self) {
    struct recording_sound *s = self;
    sf_count_t left = memory_size(s) - s->at, size = count < left ? count : left;
    if (size <= 0)
        return 0;
    memcpy(to, s->memory->data + s->at, (size_t)size);
    s->at += size;
    return size;
}

static sf_count_t memory_write(const void *from, sf_count_t count, void *self) {
    (void)from, (void)count, (void)self;
    return 0;
}

static sf_count_t memory_tell(void *self) {
    return ((struct recording_sound *)self)->at;
}

int recording_sound_beside(const char *folder, const char *fap_path) {
    size_t stem = strlen(fap_path);
    int fd = -1;
    if (stem > 4 && !strcmp(fap_path + stem - 4, ".fap"))
        stem -= 4;
    for (const char *const *ending = recording_sounds; fd < 0 && *ending; ending++) {
        size_t size = stem + strlen(*ending) + 2;
        char *path = mem_alloc(size);
        snprintf(path, size, "%.*s.%s", (int)stem, fap_path, *ending);
        fd = folder ? beneath_open(folder, path, O_RDONLY) : open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        free(path);
    }
    return fd;
}

/* The source's sound; NULL = it has none, or it cannot be read. */
static SNDFILE *open_file(struct recording_sound *s, const struct recording_source *source, bool *there) {
    static SF_VIRTUAL_IO memory = {memory_size, memory_seek, memory_read, memory_write, memory_tell};
    *there = true;
    s->memory = &source->sound;
    if (source->sound_path)
        return wav_file_open(source->sound_path, &s->info);
    if (source->sound.size) {
        wav_file_mend(source->sound.data, source->sound.size);
        return sf_open_virtual(&memory, SFM_READ, &s->info, s);
    }
    int fd = source->fap_path ? recording_sound_beside(source->folder, source->fap_path) : -1;
    *there = fd >= 0;
    return fd >= 0 ? wav_file_open_fd(fd, SF_TRUE, &s->info) : NULL; /* which closes it in any case */
}

int recording_sound_open(struct recording_sound **sound, const struct recording_source *source,
                         struct error *e) {
    struct recording_sound *s = mem_alloc(sizeof *s);
    int failed = 0;
    bool there;
    *sound = NULL;
    s->file = open_file(s, source, &there);
    if (!there) {
        free(s);
        return 0;
    }
    const SF_INFO *info = &s->info;
    if (!s->file)
        failed = error_set(e, ERROR_BAD_SOUND, "%s", sf_strerror(NULL));
    else if (info->samplerate < RATE_MIN || info->samplerate > RATE_MAX)
        failed = error_set(e, ERROR_BAD_SOUND, "the sample rate must be %d to %d Hz, not %d", RATE_MIN,
                           RATE_MAX, info->samplerate);
    else if (info->channels > CHANNELS_MAX)
        failed =
            error_set(e, ERROR_BAD_SOUND, "it may have %d channels, not %d", CHANNELS_MAX, info->channels);
    if (failed) {
        recording_sound_close(s);
        return -1;
    }
    s->block = mem_alloc((size_t)BLOCK * (size_t)info->channels * sizeof *s->block);
    *sound = s;
    return 0;
}

void recording_sound_close(struct recording_sound *s) {
    if (!s)
        return;
    if (s->file)
        sf_close(s->file);
    free(s->block);
    free(s);
}

uint32_t recording_sound_rate(const struct recording_sound *s) {
    return (uint32_t)s->info.samplerate;
}

static int16_t mix(struct recording_sound *s, const float *frame) {
    double value = mixdown_frame(&s->mixdown, frame, (unsigned)s->info.channels) * 32768;
    return (int16_t)(value >= 32767 ? 32767 : value <= -32768 ? -32768 : lrint(value));
}

uint32_t recording_sound_read(struct recording_sound *s, int16_t *pcm, uint32_t count) {
    uint32_t done = 0;
    while (done < count) {
        sf_count_t want = count - done < BLOCK ? count - done : BLOCK;
        sf_count_t got = sf_readf_float(s->file, s->block, want);
        for (sf_count_t i = 0; i < got; i++)
            pcm[done + (uint32_t)i] = mix(s, s->block + i * s->info.channels);
        done += got > 0 ? (uint32_t)got : 0;
        if (got < want)
            break;
    }
    return done;
}
