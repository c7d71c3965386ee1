/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound in the formats of libsndfile (MP3, FLAC), as AAC, and as bare samples. */
#include "server/base/mem.h"
#include "server/export/aac_coder.h"
#include "server/export/export.h"
#include <sndfile.h>
#include <soxr.h>
#include <stdlib.h>
#include <string.h>

/* libsndfile's scale from the highest to the lowest bit rate: 64 kbit/s up to 24 kHz, 160 above. */
#define MP3_LEVEL 0.6

/* The rate of sound in MP3 and AAC: its own if that is one of MPEG-1, MPEG-2 (ISO/IEC 13818-3) or 2.5. */
static uint32_t mpeg_rate(uint32_t rate) {
    static const uint32_t rates[] = {8000, 11025, 12000, 16000, 22050, 24000, 32000, 44100, 48000};
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++)
        if (rates[i] == rate)
            return rate;
    return 24000;
}

struct sound_coder {
    SNDFILE *file;         /* NULL: AAC or bare samples */
    struct aac_coder *aac; /* NULL: another format */
    soxr_t resample;       /* NULL: the voice's rate is kept */
    uint32_t from, to;
    struct buf *out;
    bool streams;        /* `out` is consumed from the front */
    sf_count_t at, size; /* position and length of the file */
};

static sf_count_t file_size(void *self) {
    const struct sound_coder *c = self;
    return c->size;
}

static sf_count_t file_seek(sf_count_t offset, int whence, void *self) {
    struct sound_coder *c = self;
    c->at = offset + (whence == SEEK_SET ? 0 : whence == SEEK_CUR ? c->at : c->size);
    return c->at;
}

static sf_count_t file_tell(void *self) {
    const struct sound_coder *c = self;
    return c->at;
}

static sf_count_t file_read(void *data, sf_count_t count, void *self) {
    (void)data;
    (void)count;
    (void)self;
    return 0;
}

/* Encoders rewrite their headers at the end. A streamed format drops that, since the header may have been
 * sent already: an MP3 then has no length and begins with a silent frame. */
static sf_count_t file_write(const void *data, sf_count_t count, void *self) {
    struct sound_coder *c = self;
    const uint8_t *bytes = data;
    sf_count_t behind = c->size - c->at, old = behind < count ? behind : count;
    if (!c->streams && old > 0)
        memcpy(c->out->data + c->at, bytes, (size_t)old);
    if (count > old)
        buf_add(c->out, bytes + old, (size_t)(count - old));
    c->size += count - old;
    c->at += count;
    return count;
}

static void begin_sound(struct export *x, uint32_t from, uint32_t to, int format) {
    static SF_VIRTUAL_IO io = {file_size, file_seek, file_read, file_write, file_tell};
    struct sound_coder *c = x->coder = mem_alloc(sizeof *c);
    *c = (struct sound_coder){.from = from, .to = to, .out = &x->out, .streams = x->format->streams};
    if (from != to) {
        soxr_io_spec_t types = soxr_io_spec(SOXR_INT16_I, SOXR_INT16_I);
        types.flags = SOXR_NO_DITHER; /* the same sound, the same bytes */
        c->resample = soxr_create(from, to, 1, NULL, &types, NULL, NULL);
    }
    if (!format)
        return;
    SF_INFO info = {.samplerate = (int)to, .channels = 1, .format = format};
    c->file = sf_open_virtual(&io, SFM_WRITE, &info, c);
    int constant = SF_BITRATE_MODE_CONSTANT;
    double level = MP3_LEVEL;
    if (c->file && (format & SF_FORMAT_TYPEMASK) == SF_FORMAT_MPEG) {
        sf_command(c->file, SFC_SET_BITRATE_MODE, &constant, sizeof constant);
        sf_command(c->file, SFC_SET_COMPRESSION_LEVEL, &level, sizeof level);
    }
}

static void put_samples(struct sound_coder *c, const int16_t *pcm, size_t count) {
    if (c->aac) {
        aac_coder_put(c->aac, pcm, count);
        return;
    }
    if (c->file)
        sf_writef_short(c->file, pcm, (sf_count_t)count);
    else
        buf_add(c->out, pcm, 2 * count);
}

/* pcm NULL: the end of the sound. */
static void put_resampled(struct sound_coder *c, const int16_t *pcm, size_t count) {
    size_t used = 0, made, room = (size_t)((double)count * c->to / c->from) + 4096;
    int16_t *out = mem_alloc(room * sizeof *out);
    do {
        size_t now = 0;
        if (soxr_process(c->resample, pcm ? pcm + used : NULL, count - used, &now, out, room, &made))
            break;
        put_samples(c, out, made);
        used += now;
    } while (made == room || (pcm && used < count));
    free(out);
}

static void put_sound(void *ctx, const int16_t *pcm, size_t count) {
    struct sound_coder *c = ctx;
    if (c->resample)
        put_resampled(c, pcm, count);
    else
        put_samples(c, pcm, count);
}

void export_mp3_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    uint32_t rate = segment->audio->sample_rate;
    if (!x->coder)
        begin_sound(x, rate, mpeg_rate(rate), SF_FORMAT_MPEG | SF_FORMAT_MPEG_LAYER_III);
    export_samples(x, segment, to, put_sound, x->coder);
}

void export_aac_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    uint32_t rate = segment->audio->sample_rate, coded = mpeg_rate(rate);
    if (!x->coder) {
        begin_sound(x, rate, coded, 0);
        struct sound_coder *c = x->coder;
        c->aac = aac_coder_new(coded, c->out);
    }
    export_samples(x, segment, to, put_sound, x->coder);
}

void export_flac_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    uint32_t rate = segment->audio->sample_rate;
    if (!x->coder)
        begin_sound(x, rate, rate, SF_FORMAT_FLAC | SF_FORMAT_PCM_16);
    export_samples(x, segment, to, put_sound, x->coder);
}

void export_pcm_piece(struct export *x, const struct media_segment *segment, uint32_t to) {
    if (!x->coder)
        begin_sound(x, segment->audio->sample_rate, EXPORT_PCM_RATE, 0);
    export_samples(x, segment, to, put_sound, x->coder);
}

void export_sound_end(struct export *x) {
    struct sound_coder *c = x->coder;
    if (!c)
        return;
    if (c->resample)
        put_resampled(c, NULL, 0);
    if (c->aac)
        aac_coder_end(c->aac);
    if (c->file)
        sf_close(c->file);
    c->file = NULL;
}

void export_sound_free(struct export *x) {
    struct sound_coder *c = x->coder;
    if (!c)
        return;
    if (c->file)
        sf_close(c->file);
    aac_coder_free(c->aac);
    soxr_delete(c->resample);
    free(c);
    x->coder = NULL;
}
