/* SPDX-License-Identifier: MIT */
/* FBA: face animation parameters at a few kilobits a second. The coding is described in fba.md; this is the
 * same thing as fba.mjs, to the byte. Nothing here allocates, does I/O or uses floating point. */
#ifndef FACCIA_PROTOCOL_FBA_H
#define FACCIA_PROTOCOL_FBA_H

#include "protocol/fap.h"
#include <stddef.h>

enum {
    FBA_QUALITY_LOSSLESS = 0, /* values as they are */
    FBA_QUALITY_MAX = 31,
    FBA_QUALITY = 5, /* default: lips of a common head within 0.2 mm, its turns within 0.15 degrees */
    /* Largest magnitude of a value that can be coded; larger ones are limited to it. */
    FBA_VALUE_MAX = 1 << 24,
    FBA_FRAMES_MAX = 64, /* in one packet */
    /* A packet never has more bytes than this for each of its frames, and this once more: 66 values, each of
     * at most 45 bits at 10 bits each and 30 even ones, the mask, FAP 1 and FAP 2. */
    FBA_FRAME_BYTES_MAX = 4200,
};

/* Adaptive probabilities: contexts of the arithmetic coder. */
enum {
    FBA_WEIGHTS = 7,
    FBA_GROUPS = 11,
    FBA_ZEROS = 24,
    FBA_SIGNS = 15,
    FBA_CLASSES = 6,
    FBA_UNARY = 12,
    FBA_LONG = 32,
    FBA_CTX_SIGN = (FAP_COUNT + 1) * FBA_ZEROS,
    FBA_CTX_SIZE = FBA_CTX_SIGN + (FAP_COUNT + 1) * FBA_SIGNS,
    FBA_CTX_LONG = FBA_CTX_SIZE + FBA_GROUPS * FBA_CLASSES * FBA_UNARY,
    FBA_CTX_MASK = FBA_CTX_LONG + FBA_GROUPS * FBA_LONG,
    FBA_CTX_HIGH = FBA_CTX_MASK + 3,
    FBA_CTX_COUNT = FBA_CTX_HIGH + 10,
};

struct fba_context {
    uint16_t zero; /* probability of a 0, of 65536 */
    uint8_t seen;
};

/* What encoder and decoder have in common: both change it in the same way with every frame. */
struct fba_state {
    uint8_t quality;  /* 0..31 */
    uint8_t sequence; /* of the next packet, 0..127 */
    struct fba_context contexts[FBA_CTX_COUNT];
    int32_t value[4][FAP_COUNT + 1]; /* of the latest frame and those before it; what a decoder shows */
    int32_t error[FAP_COUNT + 1];    /* of the guesses of the latest frame, in steps */
    int32_t activity[FAP_COUNT + 1]; /* of these errors lately */
    struct fap_frame last;           /* mask, FAP 1 and FAP 2 of the latest frame */
};

struct fba_encoder {
    struct fba_state state;
    bool started;
};

struct fba_decoder {
    struct fba_state state;
    bool ready; /* has had a packet to begin with, and lost none since */
};

/* The quantiser step of FAP n (3..68) in FAP units. */
int32_t fba_step(int n, int quality);

/* quality 0 (lossless) to 31. */
void fba_encoder_init(struct fba_encoder *encoder, int quality);

/* One packet of the frames, in order; intra: one that a decoder can begin with (the first is so by itself).
 * A FAP that a frame's mask leaves out keeps its value. Returns the number of bytes, 0 when cap or count are
 * out of range; cap = (count + 1) * FBA_FRAME_BYTES_MAX always suffices. */
size_t fba_encode(struct fba_encoder *encoder, const struct fap_frame *frames, size_t count, bool intra,
                  uint8_t *out, size_t cap);

void fba_decoder_init(struct fba_decoder *decoder);

/* The count frames of the packet. NULL, or why there are none: then all that follows up to the next packet to
 * begin with is refused too. Any bytes may be given; at worst the values are nonsense,
 * not over FBA_VALUE_MAX by more than two steps. */
const char *fba_decode(struct fba_decoder *decoder, const uint8_t *data, size_t size,
                       struct fap_frame *frames, size_t count);

#endif
