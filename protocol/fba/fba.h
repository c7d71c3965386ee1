/* SPDX-License-Identifier: MIT */
/* The face part of the FBA bitstream of MPEG-4 (ISO/IEC 14496-2, clauses 6.2.10 and 7.12), which other
 * programs use in streams and in files (.fba, .bits). Reads and writes arithmetic coding with I and P frames.
 * What the public sources leave open is in protocol/mpeg4.md. Works on memory.
 *
 * Fields: frame rate 8 + 4 + 1 bits, fap_quant 5, ten group masks, new ranges 5 each. A value is coded in
 * levels of quant_step * fap_quant FAP units (fap.h); in an I frame it is itself a level, in a P frame its
 * difference from the value shown before. */
#ifndef FACCIA_PROTOCOL_FBA_H
#define FACCIA_PROTOCOL_FBA_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>

enum {
    FBA_QUANT_MAX = 31,
    FBA_QUANT = 4,              /* default */
    FBA_FRAMES_MAX = 1 << 20,   /* that a reader accepts: 11 hours at 25 a second */
    FBA_FPS_MAX = 255,          /* that the stream can state */
    FBA_INTRA_SECONDS = 10,     /* default distance of the I frames */
    FBA_FRAME_BYTES_MAX = 4096, /* of one coded frame: 66 values of at most 14 bits and their ranges */
};

struct fba_error {
    size_t byte;         /* 0-based */
    int bit;             /* within it, 0 is the highest */
    const char *message; /* static */
};

struct fba_file {
    double fps;
    size_t count;
    struct fap_frame *frames;
    uint8_t interpolated[FAP_MASK_BYTES]; /* FAPs that the stream leaves to the receiver's interpolation, by
                                             masks of type 2; as fap_frame's mask */
};

/* Does it begin with a start code of such a stream? */
bool fba_is(const uint8_t *data, size_t size);

struct fba_limits {
    size_t frames;           /* at most these; a stream may need less than a byte for one */
    bool (*stop)(void *ctx); /* asked before each frame; true ends it with the error "stopped". May be NULL */
    void *ctx;
};

/* Decodes data[0..size). limits may be NULL: FBA_FRAMES_MAX. 0: free *out with fba_free. -1: *error says why
 * and *out is unchanged. The values of FAP 1 and 2 are limited to their ranges. A frame with skip_frames is
 * repeated as often as it says. */
int fba_read(const uint8_t *data, size_t size, const struct fba_limits *limits, struct fba_file *out,
             struct fba_error *error);
void fba_free(struct fba_file *file);

struct fba_options {
    int quant;            /* 1..FBA_QUANT_MAX; 0: FAP units themselves, for values within +-1860 */
    double intra_seconds; /* over 0: I frames at most this far apart */
    const uint8_t *left;  /* FAPs that receivers interpolate (fapfit.h), as fap_frame's mask; NULL: none */
};

struct fba_written {
    uint8_t *data; /* malloc'ed */
    size_t size;
    size_t limited; /* values outside the range that the stream can state, limited to it */
    size_t intra;   /* I frames */
};

/* Encodes frames at fps (over 0, at most FBA_FPS_MAX; kept to the sixteenth, or to a sixteenth * 1000/1001).
 * An I frame is written where the mask changes, where a difference leaves the range of P frames, and after
 * intra_seconds; it states the ranges of the values up to the next. 0, or -1 when an argument is out of range
 * or memory is short. */
int fba_write(const struct fap_frame *frames, size_t count, double fps, const struct fba_options *options,
              struct fba_written *out);

#endif
