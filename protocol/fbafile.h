/* SPDX-License-Identifier: MIT */
/* .fba files: FAP frames coded by fba.h behind a short header. The bytes are described in fba.md, "Files".
 * Works on memory. */
#ifndef FACCIA_PROTOCOL_FBAFILE_H
#define FACCIA_PROTOCOL_FBAFILE_H

#include "protocol/fba.h"

enum {
    FBAFILE_HEADER_BYTES = 8,
    FBAFILE_PACKET_BYTES = 3,            /* before each packet */
    FBAFILE_PACKET_FRAMES = 5,           /* in one packet, */
    FBAFILE_PACKET_MS = 120,             /* or as many as last so long when those are more */
    FBAFILE_BEGIN_SECONDS = 10,          /* at least so often one can begin */
    FBAFILE_FRAMES_MAX = 1 << 20,        /* that a reader takes: 11 hours at 25 a second */
    FBAFILE_FPS_HUNDREDTHS_MAX = 100000, /* 1000 a second, as FAPFILE_FPS_MAX */
};

struct fbafile {
    double fps;
    size_t count;
    struct fap_frame *frames;
};

struct fbafile_error {
    size_t byte;         /* 0-based: where the header or the packet begins that is not right */
    const char *message; /* static */
};

/* Does it begin as such a file does? */
bool fbafile_is(const uint8_t *data, size_t size);

/* Decodes all of data[0..size). 0 on success: release with fbafile_free. -1: *error says why, *out is
 * untouched. */
int fbafile_read(const uint8_t *data, size_t size, struct fbafile *out, struct fbafile_error *error);
void fbafile_free(struct fbafile *file);

/* Writes packet by packet. Owns nothing. */
struct fbafile_writer {
    struct fba_encoder encoder;
    size_t frames;      /* that each packet but the last should have, 1..FBA_FRAMES_MAX */
    size_t begin_every; /* packets */
    size_t packets;     /* so far */
};

/* fps: over 0, at most 1000; kept to the hundredth. quality as of fba_encoder_init. Writes the header. */
void fbafile_begin(struct fbafile_writer *writer, double fps, int quality, uint8_t out[FBAFILE_HEADER_BYTES]);

enum { FBAFILE_PACKET_CAP = FBAFILE_PACKET_BYTES + (FBA_FRAMES_MAX + 1) * FBA_FRAME_BYTES_MAX };

/* One packet of 1..FBA_FRAMES_MAX frames; cap = FBAFILE_PACKET_CAP always suffices. Its bytes, or 0 when
 * count or cap are out of range or the packet is larger than a file can say (only of nonsense: 64 KiB). */
size_t fbafile_packet(struct fbafile_writer *writer, const struct fap_frame *frames, size_t count,
                      uint8_t *out, size_t cap);

#endif
