/* SPDX-License-Identifier: MIT */
/* A media chunk: the audio of an interval and the FAP frames of the same interval, one binary message.
 * The layout is in ../README.md, section "Media chunks". Nothing here allocates or does I/O. */
#ifndef FACCIA_PROTOCOL_CHUNK_H
#define FACCIA_PROTOCOL_CHUNK_H

#include "protocol/fap.h"
#include <stddef.h>

enum {
    CHUNK_VERSION = 1,
    CHUNK_HEADER_BYTES = 32,
    /* Largest code of one frame in the plain FAP codec: mask, FAP 1 and 2, 66 varints of at most 5 bytes. */
    CHUNK_FRAME_BYTES_MAX = FAP_MASK_BYTES + 4 + 6 + 66 * 5,
};

enum chunk_audio { CHUNK_AUDIO_SILENCE = 0, CHUNK_AUDIO_PCM_S16LE = 1 };
enum chunk_fap { CHUNK_FAP_NONE = 0, CHUNK_FAP_PLAIN = 1 };

struct chunk {
    uint8_t audio_codec; /* enum chunk_audio */
    uint8_t fap_codec;   /* enum chunk_fap */
    uint32_t utterance;
    uint32_t sample_rate;  /* Hz */
    uint16_t fps_hundreds; /* frame rate * 100 */
    uint16_t frame_count;
    uint32_t start;   /* first sample, counted from the utterance's beginning */
    uint32_t samples; /* duration */
    uint32_t
        first_frame; /* number of the first frame; frame k stands at sample k*100*sample_rate/fps_hundreds */
    uint32_t audio_bytes;
    const uint8_t *audio; /* borrowed */
    uint32_t
        first_packet; /* compact chunks with Opus: number of the first packet, from the utterance's first */
    uint32_t events_bytes; /* compact chunks: packed.h */
    const uint8_t *events; /* borrowed; before the audio */
};

/* Writes header, audio and the frames (chunk->frame_count of them, codec chunk->fap_codec) to out. FAPs
 * missing from a frame's mask count as 0. Does not check values against the FAPs' ranges. Returns the number
 * of bytes, or 0 when cap is too small or a field is out of range. cap = CHUNK_HEADER_BYTES + audio_bytes +
 * frame_count * CHUNK_FRAME_BYTES_MAX always suffices. */
size_t chunk_encode(const struct chunk *chunk, const struct fap_frame *frames, uint8_t *out, size_t cap);

/* Reads the header, points chunk->audio into data, and checks all frames; the first frame_cap of them go to
 * frames, with every FAP in their masks. Returns NULL, or a static sentence that says what is wrong;
 * *error_at is then the byte where, and *chunk and frames mean nothing. Values may be outside the FAPs'
 * ranges: see fap_clamp. start + samples and first_frame + frame_count may exceed 32 bits. */
const char *chunk_decode(const uint8_t *data, size_t size, struct chunk *chunk, struct fap_frame *frames,
                         size_t frame_cap, size_t *error_at);

#endif
