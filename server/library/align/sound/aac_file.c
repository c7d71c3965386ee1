/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/sound/aac_file.h"
#include <string.h>

bool aac_file_is(const uint8_t *data, size_t size) {
    return size >= 12 && !memcmp(data + 4, "ftyp", 4);
}

#ifdef HAVE_FAAD
#include "server/base/mem.h"
#include "server/library/align/sound/mp4_track.h"
#include <neaacdec.h>
#include <stdlib.h>

#define CODE ERROR_BAD_SOUND

enum {
    CHANNELS_MAX = 8,
    FRAME_SAMPLES_MAX = 4096, /* of a channel */
    FRAME_BYTES_MAX = 65536,  /* coded */
    PREROLL = 2,              /* frames decoded before the wanted one, whose overlap it needs */
};

struct aac_file {
    const uint8_t *data;
    struct mp4_track track;
    NeAACDecHandle decoder;
    unsigned channels, rate, per_frame; /* per_frame: samples of a channel */
    uint64_t skip, samples;             /* skip: samples before the sound begins */
    uint64_t at;                        /* of the virtual file, in bytes */
    size_t next;                        /* frame that the decoder expects */
    size_t held;                        /* frame + 1 in `pcm`; 0: none */
    int16_t pcm[FRAME_SAMPLES_MAX * CHANNELS_MAX];
};

/* Decodes the next frame into `pcm`; silence if it is damaged, or while the decoder starts. */
static void decode(struct aac_file *f) {
    const struct mp4_frame *frame = &f->track.frames[f->next];
    NeAACDecFrameInfo info = {0};
    size_t most = (size_t)f->per_frame * f->channels;
    const int16_t *got = frame->size && frame->size <= FRAME_BYTES_MAX
                             ? NeAACDecDecode(f->decoder, &info, (uint8_t *)f->data + frame->at, frame->size)
                             : NULL;
    size_t count = got && !info.error && info.channels == f->channels ? info.samples : 0;
    count = count < most ? count : most;
    memset(f->pcm, 0, most * sizeof *f->pcm);
    if (count)
        memcpy(f->pcm, got, count * sizeof *f->pcm);
    f->held = ++f->next;
}

static void hold(struct aac_file *f, size_t frame) {
    if (f->held == frame + 1)
        return;
    if (frame < f->next || frame > f->next + PREROLL) {
        f->next = frame > PREROLL ? frame - PREROLL : 0;
        NeAACDecPostSeekReset(f->decoder, (long)f->next);
    }
    while (f->next <= frame)
        decode(f);
}

/* ---- the virtual file: headerless samples of 16 bits ---- */

static sf_count_t get_size(void *ctx) {
    const struct aac_file *f = ctx;
    return (sf_count_t)(f->samples * f->channels * sizeof(int16_t));
}

static sf_count_t seek(sf_count_t offset, int whence, void *ctx) {
    struct aac_file *f = ctx;
    sf_count_t size = get_size(f), to = offset + (whence == SEEK_CUR   ? (sf_count_t)f->at
                                                  : whence == SEEK_END ? size
                                                                       : 0);
    f->at = (uint64_t)(to < 0 ? 0 : to > size ? size : to);
    return (sf_count_t)f->at;
}

static sf_count_t get(void *out, sf_count_t count, void *ctx) {
    struct aac_file *f = ctx;
    const size_t width = f->channels * sizeof(int16_t), frame_bytes = f->per_frame * width;
    sf_count_t done = 0, size = get_size(f);
    if (count > size - (sf_count_t)f->at)
        count = size - (sf_count_t)f->at;
    while (done < count) {
        uint64_t from = f->at + f->skip * width;
        size_t frame = (size_t)(from / frame_bytes), into = (size_t)(from % frame_bytes);
        size_t n = frame_bytes - into;
        if ((sf_count_t)n > count - done)
            n = (size_t)(count - done);
        hold(f, frame);
        memcpy((char *)out + done, (char *)f->pcm + into, n);
        done += (sf_count_t)n;
        f->at += n;
    }
    return done;
}

static sf_count_t put(const void *data, sf_count_t count, void *ctx) {
    (void)data, (void)count, (void)ctx;
    return 0;
}

static sf_count_t tell(void *ctx) {
    return (sf_count_t)((struct aac_file *)ctx)->at;
}

SNDFILE *aac_file_sound(struct aac_file *f, SF_INFO *info) {
    SF_VIRTUAL_IO io = {get_size, seek, get, put, tell};
    *info = (SF_INFO){.samplerate = (int)f->rate,
                      .channels = (int)f->channels,
                      .format = SF_FORMAT_RAW | SF_FORMAT_PCM_16 | SF_ENDIAN_CPU};
    f->at = 0;
    return sf_open_virtual(&io, SFM_READ, info, f);
}

/* Starts the decoder, and learns rate and channels from the first frames: a configuration may leave open that
 * the high frequencies are coded apart (SBR). */
static int start(struct aac_file *f, struct error *e) {
    unsigned long rate = 0;
    unsigned char channels = 0;
    NeAACDecFrameInfo info = {0};
    f->decoder = NeAACDecOpen();
    NeAACDecConfigurationPtr c = f->decoder ? NeAACDecGetCurrentConfiguration(f->decoder) : NULL;
    if (!c)
        return error_set(e, CODE, "the decoder of AAC does not start");
    c->outputFormat = FAAD_FMT_16BIT;
    if (!NeAACDecSetConfiguration(f->decoder, c) ||
        NeAACDecInit2(f->decoder, (uint8_t *)f->track.config, f->track.config_size, &rate, &channels) < 0)
        return error_set(e, CODE, "this kind of AAC cannot be decoded");
    for (size_t i = 0; i < f->track.count && i < 3; i++) {
        const struct mp4_frame *frame = &f->track.frames[i];
        NeAACDecFrameInfo one = {0};
        if (frame->size && frame->size <= FRAME_BYTES_MAX)
            NeAACDecDecode(f->decoder, &one, (uint8_t *)f->data + frame->at, frame->size);
        if (!one.error && one.samples && one.channels)
            info = one;
    }
    if (!info.samples)
        return error_set(e, CODE, "its AAC cannot be decoded");
    f->channels = info.channels;
    f->rate = (unsigned)info.samplerate;
    f->per_frame = (unsigned)(info.samples / info.channels);
    if (f->channels > CHANNELS_MAX || f->per_frame > FRAME_SAMPLES_MAX)
        return error_set(e, CODE, "AAC of %u channels cannot be read", f->channels);
    f->next = f->track.count; /* so that the first frame is sought */
    uint64_t all = (uint64_t)f->track.count * f->per_frame;
    double scale = (double)f->rate / f->track.timescale;
    f->skip = (uint64_t)((double)f->track.skip * scale);
    f->skip = f->skip < all ? f->skip : 0;
    f->samples = all - f->skip;
    uint64_t length = (uint64_t)((double)f->track.length * scale);
    if (length && length < f->samples)
        f->samples = length;
    return 0;
}

struct aac_file *aac_file_open(const uint8_t *data, size_t size, struct error *e) {
    struct aac_file *f = mem_alloc(sizeof *f);
    f->data = data;
    if (!mp4_track_read(&f->track, data, size, e) && !start(f, e))
        return f;
    aac_file_close(f);
    return NULL;
}

void aac_file_close(struct aac_file *f) {
    if (!f)
        return;
    if (f->decoder)
        NeAACDecClose(f->decoder);
    mp4_track_free(&f->track);
    free(f);
}

#else

struct aac_file *aac_file_open(const uint8_t *data, size_t size, struct error *e) {
    (void)data, (void)size;
    error_set(e, ERROR_BAD_SOUND, "AAC cannot be read: faccia was built without FAAD2 (libfaad-dev)");
    return NULL;
}

void aac_file_close(struct aac_file *file) {
    (void)file;
}

SNDFILE *aac_file_sound(struct aac_file *file, SF_INFO *info) {
    (void)file, (void)info;
    return NULL;
}
#endif
