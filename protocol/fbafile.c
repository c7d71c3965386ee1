/* SPDX-License-Identifier: MIT */
#include "protocol/fbafile.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char magic[4] = {'F', 'B', 'A', '1'};

bool fbafile_is(const uint8_t *data, size_t size) {
    return size >= sizeof magic && !memcmp(data, magic, sizeof magic);
}

static int fail(struct fbafile_error *error, size_t byte, const char *message) {
    *error = (struct fbafile_error){byte, message};
    return -1;
}

/* Goes through the packets' heads: how many frames are there? */
static int count_frames(const uint8_t *data, size_t size, size_t *count, struct fbafile_error *error) {
    *count = 0;
    for (size_t at = FBAFILE_HEADER_BYTES, length; at < size; at += FBAFILE_PACKET_BYTES + length) {
        if (size - at < FBAFILE_PACKET_BYTES)
            return fail(error, at, "the file ends within the head of a packet");
        if (!data[at] || data[at] > FBA_FRAMES_MAX)
            return fail(error, at, "a packet must have 1 to 64 frames");
        length = data[at + 1] | (size_t)data[at + 2] << 8;
        if (size - at - FBAFILE_PACKET_BYTES < length)
            return fail(error, at, "the file ends within a packet");
        *count += data[at];
        if (*count > FBAFILE_FRAMES_MAX)
            return fail(error, at, "more frames than one file may have");
    }
    return 0;
}

static int decode(const uint8_t *data, size_t size, struct fap_frame *frames, struct fbafile_error *error) {
    struct fba_decoder decoder;
    fba_decoder_init(&decoder);
    for (size_t at = FBAFILE_HEADER_BYTES, length; at < size; at += FBAFILE_PACKET_BYTES + length) {
        length = data[at + 1] | (size_t)data[at + 2] << 8;
        const char *message =
            fba_decode(&decoder, data + at + FBAFILE_PACKET_BYTES, length, frames, data[at]);
        if (message)
            return fail(error, at, message);
        frames += data[at];
    }
    return 0;
}

int fbafile_read(const uint8_t *data, size_t size, struct fbafile *out, struct fbafile_error *error) {
    size_t count;
    if (!fbafile_is(data, size))
        return fail(error, 0, "does not begin with FBA1");
    if (size < FBAFILE_HEADER_BYTES)
        return fail(error, size, "the file ends within its header");
    uint32_t fps = data[4] | (uint32_t)data[5] << 8 | (uint32_t)data[6] << 16 | (uint32_t)data[7] << 24;
    if (!fps || fps > FBAFILE_FPS_HUNDREDTHS_MAX)
        return fail(error, sizeof magic, "the frame rate is not over 0 and at most 1000");
    if (count_frames(data, size, &count, error))
        return -1;
    struct fap_frame *frames = calloc(count ? count : 1, sizeof *frames);
    if (!frames)
        return fail(error, 0, "not enough memory");
    if (decode(data, size, frames, error)) {
        free(frames);
        return -1;
    }
    *out = (struct fbafile){fps / 100.0, count, frames};
    return 0;
}

void fbafile_free(struct fbafile *file) {
    free(file->frames);
    *file = (struct fbafile){0};
}

void fbafile_begin(struct fbafile_writer *writer, double fps, int quality,
                   uint8_t out[FBAFILE_HEADER_BYTES]) {
    long hundredths = fps > 0 ? lround(fps * 100) : 0;
    hundredths = hundredths < 1 ? 1 : hundredths;
    hundredths = hundredths > FBAFILE_FPS_HUNDREDTHS_MAX ? FBAFILE_FPS_HUNDREDTHS_MAX : hundredths;
    long frames = hundredths * FBAFILE_PACKET_MS / 100000;
    frames = frames < FBAFILE_PACKET_FRAMES ? FBAFILE_PACKET_FRAMES : frames;
    frames = frames > FBA_FRAMES_MAX ? FBA_FRAMES_MAX : frames;
    long every = hundredths * FBAFILE_BEGIN_SECONDS / 100 / frames;
    *writer = (struct fbafile_writer){.frames = (size_t)frames, .begin_every = every < 1 ? 1 : (size_t)every};
    fba_encoder_init(&writer->encoder, quality);
    memcpy(out, magic, sizeof magic);
    for (int i = 0; i < 4; i++)
        out[4 + i] = (uint8_t)((uint32_t)hundredths >> (8 * i));
}

size_t fbafile_packet(struct fbafile_writer *writer, const struct fap_frame *frames, size_t count,
                      uint8_t *out, size_t cap) {
    if (!count || count > FBA_FRAMES_MAX || cap < FBAFILE_PACKET_BYTES)
        return 0;
    bool intra = writer->packets % writer->begin_every == 0;
    size_t length = fba_encode(&writer->encoder, frames, count, intra, out + FBAFILE_PACKET_BYTES,
                               cap - FBAFILE_PACKET_BYTES);
    if (!length || length > UINT16_MAX)
        return 0;
    writer->packets++;
    out[0] = (uint8_t)count;
    out[1] = (uint8_t)length;
    out[2] = (uint8_t)(length >> 8);
    return FBAFILE_PACKET_BYTES + length;
}
