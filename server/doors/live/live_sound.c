/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/live/live_sound.h"
#include "server/base/mem.h"
#include "server/base/wav_file.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <sndfile.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    SECOND = 1000000, /* of the clock */
    RATE_LEAST = 8000,
    RATE_MOST = 96000,
    CHANNELS_MOST = 8,
    /* A pipe's clock may run fast: those of sound cards do by less than one in so many. */
    FAST_PART = 500,
    /* What may be made up for at once: of a file little, as it waits; of a pipe what one holds. */
    BEHIND_FILE = 10, /* of a second */
    BEHIND_PIPE = 2,  /* seconds */
    AT_ONCE = 4,      /* of a second */
};

struct live_sound {
    SNDFILE *file; /* NULL: samples as they are, from fd */
    int fd;
    unsigned rate, channels;
    bool flows, begun;
    uint64_t clock, read; /* when it began; frames since then, with those that nobody waited for */
    struct buf odd;       /* part of a frame, of a pipe */
    float *frames;
};

static int fail(const char *name, const char *why) {
    fprintf(stderr, "faccia-live: %.200s: %s\n", name, why);
    return -1;
}

static int open_file(struct live_sound *s, const char *name) {
    SF_INFO info = {0};
    s->file = s->fd == STDIN_FILENO ? wav_file_open_fd(s->fd, SF_FALSE, &info) : wav_file_open(name, &info);
    if (!s->file)
        return fail(name, sf_strerror(NULL));
    if (info.channels > CHANNELS_MOST || info.samplerate < RATE_LEAST || info.samplerate > RATE_MOST)
        return fail(name, "1 to 8 channels of 8000 to 96000 samples a second can be sent");
    s->rate = (unsigned)info.samplerate;
    s->channels = (unsigned)info.channels;
    s->frames = mem_alloc(sizeof *s->frames * (s->rate / AT_ONCE) * s->channels);
    return 0;
}

static int open_sound(struct live_sound *s, const char *name) {
    struct stat stat;
    bool in = !strcmp(name, "-");
    s->fd = in ? STDIN_FILENO : s->rate ? open(name, O_RDONLY | O_CLOEXEC) : -1;
    if (s->rate && s->fd < 0)
        return fail(name, strerror(errno));
    bool file = s->fd < 0 || (!fstat(s->fd, &stat) && S_ISREG(stat.st_mode));
    s->flows = !file;
    if (!s->rate && in && !file)
        return fail("-", "how many samples a second are they? Tell it: --raw 16000");
    return s->rate ? 0 : open_file(s, name);
}

struct live_sound *live_sound_open(const char *name, unsigned rate, unsigned channels) {
    struct live_sound *s = mem_alloc(sizeof *s);
    *s = (struct live_sound){.rate = rate, .channels = channels, .fd = -1};
    if (!open_sound(s, name))
        return s;
    live_sound_close(s);
    return NULL;
}

void live_sound_close(struct live_sound *s) {
    if (!s)
        return;
    if (s->file)
        sf_close(s->file);
    if (s->fd > STDIN_FILENO)
        close(s->fd);
    free(s->frames);
    buf_free(&s->odd);
    free(s);
}

unsigned live_sound_rate(const struct live_sound *s) {
    return s->rate;
}

unsigned live_sound_channels(const struct live_sound *s) {
    return s->channels;
}

bool live_sound_flows(const struct live_sound *s) {
    return s->flows;
}

static size_t frames_due(struct live_sound *s, uint64_t now) {
    const uint64_t behind = s->flows ? BEHIND_PIPE * s->rate : s->rate / BEHIND_FILE;
    if (!s->begun)
        s->clock = now;
    s->begun = true;
    uint64_t gone = now - s->clock;
    uint64_t due = (gone + (s->flows ? gone / FAST_PART : 0)) * s->rate / SECOND;
    if (due > s->read + behind)
        s->read = due - behind;
    uint64_t count = due > s->read ? due - s->read : 0;
    return count < s->rate / AT_ONCE ? (size_t)count : s->rate / AT_ONCE;
}

static bool read_file(struct live_sound *s, size_t count, struct buf *out) {
    sf_count_t got = sf_readf_float(s->file, s->frames, (sf_count_t)count);
    size_t values = got > 0 ? (size_t)got * s->channels : 0;
    uint8_t *bytes = buf_reserve(out, 2 * values + 1);
    for (size_t i = 0; i < values; i++) {
        int value = (int)lrintf(fmaxf(-32768, fminf(32767, s->frames[i] * 32768)));
        bytes[2 * i] = (uint8_t)(value & 255);
        bytes[2 * i + 1] = (uint8_t)(value >> 8 & 255);
    }
    out->size += 2 * values;
    s->read += got > 0 ? (uint64_t)got : 0;
    return got == (sf_count_t)count;
}

static bool read_pipe(struct live_sound *s, size_t count, struct buf *out) {
    struct pollfd look = {.fd = s->fd, .events = POLLIN};
    const size_t frame = 2 * (size_t)s->channels, want = count * frame - s->odd.size;
    if (poll(&look, 1, 0) <= 0)
        return true;
    ssize_t got = read(s->fd, buf_reserve(&s->odd, want), want);
    if (got <= 0)
        return got < 0 && (errno == EINTR || errno == EAGAIN);
    s->odd.size += (size_t)got;
    size_t whole = s->odd.size / frame;
    buf_add(out, s->odd.data, whole * frame);
    buf_consume(&s->odd, whole * frame);
    s->read += whole;
    return true;
}

bool live_sound_read(struct live_sound *s, uint64_t now, struct buf *samples) {
    size_t count = frames_due(s, now);
    return !count || (s->file ? read_file(s, count, samples) : read_pipe(s, count, samples));
}
