/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/sound/sound_file.h"
#include "server/base/mem.h"
#include "server/base/sound/wav_file.h"
#include "server/library/align/sound/aac_file.h"
#include "server/library/align/sound/book_sound.h"
#include "server/library/align/sound/mono_reader.h"
#include <errno.h>
#include <fcntl.h>
#include <sndfile.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { CHANNELS_MAX = MIXDOWN_CHANNELS_MAX, RATE_MIN = 8000, RATE_MAX = 192000 };

#define CODE ERROR_BAD_SOUND

struct sound_file {
    struct book_sound *book; /* instead of the following */
    void *map;               /* of an MP4 file; NULL: libsndfile reads the file by itself */
    size_t map_size;
    struct aac_file *aac;
    SNDFILE *file;
    struct mono_reader reader;
    struct sound_source source;
};

static size_t read_frames(void *ctx, uint64_t from, int16_t *out, size_t count) {
    struct sound_file *s = ctx;
    return mono_reader_read(&s->reader, from, out, count);
}

/* Maps the file if it is MP4. Returns whether it is; what is wrong with it, in *e with `aac` NULL. */
static bool map_mp4(struct sound_file *s, const char *path, struct error *e) {
    uint8_t head[12];
    struct stat status;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool is = fd >= 0 && !fstat(fd, &status) && S_ISREG(status.st_mode) &&
              read(fd, head, sizeof head) == (ssize_t)sizeof head && aac_file_is(head, sizeof head);
    if (is) {
        s->map_size = (size_t)status.st_size;
        s->map = mmap(NULL, s->map_size, PROT_READ, MAP_PRIVATE, fd, 0);
        if (s->map == MAP_FAILED) {
            s->map = NULL;
            error_set(e, CODE, "%s", strerror(errno));
        } else {
            s->aac = aac_file_open(s->map, s->map_size, e);
        }
    }
    if (fd >= 0)
        close(fd);
    return is;
}

struct sound_file *sound_open(const char *path, struct error *e) {
    struct sound_file *s = mem_alloc(sizeof *s);
    SF_INFO info = {0};
    if (book_sound_is(path)) {
        s->book = book_sound_open(path, e);
        if (s->book) {
            s->source = book_sound_source(s->book);
            return s;
        }
        sound_close(s);
        return NULL;
    }
    struct error why;
    bool mp4 = map_mp4(s, path, &why);
    if (s->aac)
        s->file = aac_file_sound(s->aac, &info);
    else if (!mp4)
        s->file = wav_file_open(path, &info);
    if (mp4 && !s->aac)
        error_set(e, CODE, "%.160s: %.120s", path, why.message);
    else if (!s->file)
        error_set(e, CODE, "%.160s: %s", path, wav_file_error());
    else if (info.channels < 1 || info.channels > CHANNELS_MAX)
        error_set(e, CODE, "%.160s: %d channels; the limit is %d", path, info.channels, CHANNELS_MAX);
    else if (info.samplerate < RATE_MIN || info.samplerate > RATE_MAX)
        error_set(e, CODE, "%.160s: %d samples per second; must be %d to %d", path, info.samplerate, RATE_MIN,
                  RATE_MAX);
    else if (info.frames < 1 || !info.seekable)
        error_set(e, CODE, "%.160s: contains no sound", path);
    else {
        mono_reader_begin(&s->reader, s->file, info.channels);
        s->source = (struct sound_source){read_frames, s, (uint32_t)info.samplerate, (uint64_t)info.frames};
        return s;
    }
    sound_close(s);
    return NULL;
}

void sound_close(struct sound_file *s) {
    if (s && s->file)
        sf_close(s->file);
    if (s) {
        aac_file_close(s->aac);
        if (s->map)
            munmap(s->map, s->map_size);
        book_sound_close(s->book);
    }
    free(s);
}

const struct sound_source *sound_source(const struct sound_file *s) {
    return &s->source;
}

size_t sound_clips(struct sound_file *s, struct sound_clip **clips) {
    *clips = NULL;
    return s->book ? book_sound_clips(s->book, clips) : 0;
}

void sound_clips_free(struct sound_clip *clips, size_t count) {
    for (size_t i = 0; i < count; i++)
        free(clips[i].text);
    free(clips);
}

static size_t read_memory(void *ctx, uint64_t from, int16_t *out, size_t count) {
    const struct sound_memory *m = ctx;
    size_t left = from < m->samples ? m->samples - (size_t)from : 0;
    if (count > left)
        count = left;
    if (count)
        memcpy(out, m->pcm + from, count * sizeof *out);
    return count;
}

struct sound_source sound_in_memory(struct sound_memory *memory, uint32_t rate) {
    return (struct sound_source){read_memory, memory, rate, memory->samples};
}
