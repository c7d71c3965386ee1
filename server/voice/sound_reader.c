/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/sound_reader.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/base/sound/mixdown.h"
#include "server/base/sound/wav_file.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Processor time limit: SECONDS_LEAST, plus SECONDS_EACH per megabyte, as a megabyte of Opus can contain
 * an hour of speech, which takes half a minute to decode. The process blocks, and uses no time, while its
 * output is not read. */
enum {
    BLOCK = 4096,
    MEGABYTES = 512,
    SECONDS_LEAST = 5,
    SECONDS_EACH = 30,
    SECONDS_MOST = 1800,
    BLOCK_SECONDS = 10 /* wall time for the next block of samples */
};

/* First message of the process. Blocks of samples follow, each preceded by its size; 0 = end. */
struct greeting {
    uint32_t rate; /* 0: unreadable */
    char message[SOUND_MESSAGE_BYTES];
};

/* Decodes with libsndfile in this process. */
struct decoder {
    SNDFILE *file;
    unsigned rate, channels;
    struct mixdown mixdown;
    float *frames; /* BLOCK frames of all channels */
};

struct sound_reader {
    bool apart;
    struct decoder decoder;
    struct reader_process process;
    unsigned rate;
    float block[BLOCK]; /* samples received but not yet consumed */
    size_t at, count;
    bool ended;
    char wrong[SOUND_MESSAGE_BYTES]; /* "": none */
};

static void close_decoder(struct decoder *d) {
    if (d->file)
        sf_close(d->file);
    free(d->frames);
    *d = (struct decoder){0};
}

static bool open_decoder(struct decoder *d, int fd, const char *path, unsigned most,
                         char message[SOUND_MESSAGE_BYTES]) {
    SF_INFO info = {0};
    *d = (struct decoder){.file = path ? wav_file_open(path, &info) : wav_file_open_fd(fd, SF_TRUE, &info)};
    if (path)
        close(fd);
    most = most < MIXDOWN_CHANNELS_MAX ? most : MIXDOWN_CHANNELS_MAX;
    if (!d->file)
        snprintf(message, SOUND_MESSAGE_BYTES, "%.180s", wav_file_error());
    else if (info.samplerate < SOUND_RATE_MIN || info.samplerate > SOUND_RATE_MAX)
        snprintf(message, SOUND_MESSAGE_BYTES, "the sample rate must be %d to %d Hz, not %d", SOUND_RATE_MIN,
                 SOUND_RATE_MAX, info.samplerate);
    else if (info.channels < 1 || (unsigned)info.channels > most)
        snprintf(message, SOUND_MESSAGE_BYTES, "it may have %u channels, not %d", most, info.channels);
    else {
        d->rate = (unsigned)info.samplerate;
        d->channels = (unsigned)info.channels;
        d->frames = mem_alloc((size_t)BLOCK * d->channels * sizeof *d->frames);
        return true;
    }
    close_decoder(d);
    return false;
}

/* Decodes at most BLOCK samples; fewer at the end. */
static size_t decode(struct decoder *d, float *samples, size_t count) {
    sf_count_t got = sf_readf_float(d->file, d->frames, (sf_count_t)(count < BLOCK ? count : BLOCK));
    for (sf_count_t i = 0; i < got; i++)
        samples[i] = (float)mixdown_frame(&d->mixdown, d->frames + (size_t)i * d->channels, d->channels);
    return got > 0 ? (size_t)got : 0;
}

/* ---- child ---- */

int sound_reader_serve(unsigned most, int in, int out) {
    struct decoder d;
    struct greeting hello = {0};
    float samples[BLOCK];
    bool well = open_decoder(&d, in, NULL, most, hello.message), heard;
    hello.rate = well ? d.rate : 0;
    heard = write_all(out, &hello, sizeof hello);
    for (uint32_t count = 1; heard && well && count;) {
        count = (uint32_t)decode(&d, samples, BLOCK);
        heard = write_all(out, &count, sizeof count) && write_all(out, samples, count * sizeof *samples);
    }
    close_decoder(&d);
    return heard ? 0 : -1;
}

/* ---- parent ---- */

static struct reader_limits limits_of(int fd) {
    struct stat info;
    uint64_t bytes = fstat(fd, &info) ? 0 : (uint64_t)info.st_size;
    uint64_t seconds =
        SECONDS_LEAST + SECONDS_EACH * (bytes >> 20) + SECONDS_EACH * (bytes & 0xFFFFF) / (1 << 20);
    return (struct reader_limits){seconds < SECONDS_MOST ? (unsigned)seconds : SECONDS_MOST, MEGABYTES};
}

enum outcome {
    WELL,
    BROKEN_OFF, /* the output ended early */
    GARBAGE     /* protocol error */
};

/* Ends the process, and records the reason if the sound is incomplete. */
static void end_process(struct sound_reader *s, enum outcome outcome) {
    char why[160] = "";
    bool ended = !reader_process_end(&s->process, why, sizeof why);
    s->ended = true;
    if (outcome != WELL)
        snprintf(s->wrong, sizeof s->wrong, "the process that reads it %s",
                 outcome == GARBAGE || ended || !*why ? "made the process that reads it send invalid data"
                                                      : why);
}

static bool open_apart(struct sound_reader *s, const struct reader *reader, int fd, unsigned most,
                       const atomic_bool *given_up, char message[SOUND_MESSAGE_BYTES]) {
    const struct reader_limits limits = limits_of(fd);
    char channels[16];
    struct greeting hello;
    struct error e;
    snprintf(channels, sizeof channels, "%u", most);
    const char *const args[] = {"sound", channels, NULL};
    int failed = reader_process_start(&s->process, reader, &limits, args, fd, given_up, &e);
    close(fd);
    if (failed) {
        snprintf(message, SOUND_MESSAGE_BYTES, "%.190s", e.message);
        return false;
    }
    bool said = reader_process_read(&s->process, &hello, sizeof hello);
    if (said && hello.rate >= SOUND_RATE_MIN && hello.rate <= SOUND_RATE_MAX) {
        s->rate = hello.rate;
        return true;
    }
    bool told = said && !hello.rate && memchr(hello.message, '\0', sizeof hello.message);
    end_process(s, told ? WELL : said ? GARBAGE : BROKEN_OFF);
    snprintf(message, SOUND_MESSAGE_BYTES, "%.190s", told ? hello.message : s->wrong);
    return false;
}

struct sound_reader *sound_reader_open(const struct reader *reader, int fd, const char *path, unsigned most,
                                       const atomic_bool *given_up, char message[SOUND_MESSAGE_BYTES]) {
    struct sound_reader *s = mem_alloc(sizeof *s);
    s->apart = reader && reader->program && *reader->program;
    bool well = s->apart ? open_apart(s, reader, fd, most, given_up, message)
                         : open_decoder(&s->decoder, fd, path, most, message);
    if (!s->apart)
        s->rate = s->decoder.rate;
    if (well)
        return s;
    free(s);
    return NULL;
}

void sound_reader_close(struct sound_reader *s) {
    char why[160];
    if (!s)
        return;
    if (s->apart && !s->ended)
        reader_process_end(&s->process, why, sizeof why);
    close_decoder(&s->decoder);
    free(s);
}

unsigned sound_reader_rate(const struct sound_reader *s) {
    return s->rate;
}

/* Reads the next block from the process. */
static bool take_block(struct sound_reader *s) {
    uint32_t count;
    reader_process_go_on(&s->process, BLOCK_SECONDS);
    s->at = s->count = 0;
    bool said = reader_process_read(&s->process, &count, sizeof count), sense = said && count <= BLOCK;
    bool well = sense && reader_process_read(&s->process, s->block, count * sizeof *s->block);
    if (!well || !count)
        end_process(s, well ? WELL : said && !sense ? GARBAGE : BROKEN_OFF);
    else
        s->count = count;
    for (size_t i = 0; i < s->count; i++)
        s->block[i] = isfinite(s->block[i]) ? s->block[i] : 0;
    return s->count > 0;
}

size_t sound_reader_read(struct sound_reader *s, float *samples, size_t count) {
    size_t done = 0, got = 1;
    while (!s->apart && done < count && got) {
        got = decode(&s->decoder, samples + done, count - done);
        done += got;
    }
    while (s->apart && done < count) {
        if (s->at == s->count && (s->ended || !take_block(s)))
            break;
        got = s->count - s->at < count - done ? s->count - s->at : count - done;
        memcpy(samples + done, s->block + s->at, got * sizeof *samples);
        s->at += got;
        done += got;
    }
    return done;
}

const char *sound_reader_wrong(const struct sound_reader *s) {
    return *s->wrong ? s->wrong : NULL;
}
