/* SPDX-License-Identifier: MIT */
/* .fapc files: FAP frames coded by fapc.h behind a short header. The bytes are described in fapc.md, "Files".
 * Works on memory. */
#ifndef FACCIA_PROTOCOL_FAPCFILE_H
#define FACCIA_PROTOCOL_FAPCFILE_H

#include "protocol/fapc/fapc.h"

enum {
    FAPCFILE_HEADER_BYTES = 8,
    FAPCFILE_PACKET_BYTES = 3,            /* before each packet */
    FAPCFILE_PACKET_FRAMES = 5,           /* in one packet, */
    FAPCFILE_PACKET_MS = 120,             /* or more, for the same duration */
    FAPCFILE_BEGIN_SECONDS = 10,          /* longest distance between intra packets */
    FAPCFILE_FRAMES_MAX = 1 << 20,        /* that a reader takes: 11 hours at 25 a second */
    FAPCFILE_FPS_HUNDREDTHS_MAX = 100000, /* 1000 a second, as FAPFILE_FPS_MAX */
};

struct fapcfile {
    double fps;
    size_t count;
    struct fap_frame *frames;
};

struct fapcfile_error {
    size_t byte;         /* 0-based: where the header or the packet begins that is not right */
    const char *message; /* static */
};

/* Does it begin as such a file does? */
bool fapcfile_is(const uint8_t *data, size_t size);

/* Decodes all of data[0..size). 0 on success: release with fapcfile_free. -1: *error says why, *out is
 * untouched. */
int fapcfile_read(const uint8_t *data, size_t size, struct fapcfile *out, struct fapcfile_error *error);
void fapcfile_free(struct fapcfile *file);

/* Writes packet by packet. Owns nothing. */
struct fapcfile_writer {
    struct fapc_encoder encoder;
    size_t frames;      /* that each packet but the last should have, 1..FAPC_FRAMES_MAX */
    size_t begin_every; /* packets */
    size_t packets;     /* so far */
};

/* fps: over 0, at most 1000; kept to the hundredth. quality as of fapc_encoder_init. Writes the header. */
void fapcfile_begin(struct fapcfile_writer *writer, double fps, int quality,
                    uint8_t out[FAPCFILE_HEADER_BYTES]);

enum { FAPCFILE_PACKET_CAP = FAPCFILE_PACKET_BYTES + (FAPC_FRAMES_MAX + 1) * FAPC_FRAME_BYTES_MAX };

/* One packet of 1..FAPC_FRAMES_MAX frames; cap = FAPCFILE_PACKET_CAP always suffices. Its bytes, or 0 when
 * count or cap are out of range or the packet is larger than a file can say (only of nonsense: 64 KiB). */
size_t fapcfile_packet(struct fapcfile_writer *writer, const struct fap_frame *frames, size_t count,
                       uint8_t *out, size_t cap);

#endif
