/* SPDX-License-Identifier: MIT */
#include "protocol/fapc/fapcfile.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char magic[4] = {'F', 'P', 'C', '1'};

bool fapcfile_is(const uint8_t *data, size_t size) {
    return size >= sizeof magic && !memcmp(data, magic, sizeof magic);
}

static int fail(struct fapcfile_error *error, size_t byte, const char *message) {
    *error = (struct fapcfile_error){byte, message};
    return -1;
}

/* Goes through the packets' heads: how many frames are there? */
static int count_frames(const uint8_t *data, size_t size, size_t *count, struct fapcfile_error *error) {
    *count = 0;
    for (size_t at = FAPCFILE_HEADER_BYTES, length; at < size; at += FAPCFILE_PACKET_BYTES + length) {
        if (size - at < FAPCFILE_PACKET_BYTES)
            return fail(error, at, "the file ends within the head of a packet");
        if (!data[at] || data[at] > FAPC_FRAMES_MAX)
            return fail(error, at, "a packet must have 1 to 64 frames");
        length = data[at + 1] | (size_t)data[at + 2] << 8;
        if (size - at - FAPCFILE_PACKET_BYTES < length)
            return fail(error, at, "the file ends within a packet");
        *count += data[at];
        if (*count > FAPCFILE_FRAMES_MAX)
            return fail(error, at, "more frames than one file may have");
    }
    return 0;
}

static int decode(const uint8_t *data, size_t size, struct fap_frame *frames, struct fapcfile_error *error) {
    struct fapc_decoder decoder;
    fapc_decoder_init(&decoder);
    for (size_t at = FAPCFILE_HEADER_BYTES, length; at < size; at += FAPCFILE_PACKET_BYTES + length) {
        length = data[at + 1] | (size_t)data[at + 2] << 8;
        const char *message =
            fapc_decode(&decoder, data + at + FAPCFILE_PACKET_BYTES, length, frames, data[at]);
        if (message)
            return fail(error, at, message);
        frames += data[at];
    }
    return 0;
}

int fapcfile_read(const uint8_t *data, size_t size, struct fapcfile *out, struct fapcfile_error *error) {
    size_t count;
    if (!fapcfile_is(data, size))
        return fail(error, 0, "does not begin with FPC1");
    if (size < FAPCFILE_HEADER_BYTES)
        return fail(error, size, "the file ends within its header");
    uint32_t fps = data[4] | (uint32_t)data[5] << 8 | (uint32_t)data[6] << 16 | (uint32_t)data[7] << 24;
    if (!fps || fps > FAPCFILE_FPS_HUNDREDTHS_MAX)
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
    *out = (struct fapcfile){fps / 100.0, count, frames};
    return 0;
}

void fapcfile_free(struct fapcfile *file) {
    free(file->frames);
    *file = (struct fapcfile){0};
}

void fapcfile_begin(struct fapcfile_writer *writer, double fps, int quality,
                    uint8_t out[FAPCFILE_HEADER_BYTES]) {
    long hundredths = fps > 0 ? lround(fps * 100) : 0;
    hundredths = hundredths < 1 ? 1 : hundredths;
    hundredths = hundredths > FAPCFILE_FPS_HUNDREDTHS_MAX ? FAPCFILE_FPS_HUNDREDTHS_MAX : hundredths;
    long frames = hundredths * FAPCFILE_PACKET_MS / 100000;
    frames = frames < FAPCFILE_PACKET_FRAMES ? FAPCFILE_PACKET_FRAMES : frames;
    frames = frames > FAPC_FRAMES_MAX ? FAPC_FRAMES_MAX : frames;
    long every = hundredths * FAPCFILE_BEGIN_SECONDS / 100 / frames;
    *writer =
        (struct fapcfile_writer){.frames = (size_t)frames, .begin_every = every < 1 ? 1 : (size_t)every};
    fapc_encoder_init(&writer->encoder, quality);
    memcpy(out, magic, sizeof magic);
    for (int i = 0; i < 4; i++)
        out[4 + i] = (uint8_t)((uint32_t)hundredths >> (8 * i));
}

size_t fapcfile_packet(struct fapcfile_writer *writer, const struct fap_frame *frames, size_t count,
                       uint8_t *out, size_t cap) {
    if (!count || count > FAPC_FRAMES_MAX || cap < FAPCFILE_PACKET_BYTES)
        return 0;
    bool intra = writer->packets % writer->begin_every == 0;
    size_t length = fapc_encode(&writer->encoder, frames, count, intra, out + FAPCFILE_PACKET_BYTES,
                                cap - FAPCFILE_PACKET_BYTES);
    if (!length || length > UINT16_MAX)
        return 0;
    writer->packets++;
    out[0] = (uint8_t)count;
    out[1] = (uint8_t)length;
    out[2] = (uint8_t)(length >> 8);
    return FAPCFILE_PACKET_BYTES + length;
}
