/* SPDX-License-Identifier: MIT */
/* FAPC: face animation parameters at a few kilobits a second. The coding is described in fapc.md; this is the
 * same thing as fapc.mjs, to the byte. Nothing here allocates, does I/O or uses floating point. */
#ifndef FACCIA_PROTOCOL_FAPC_H
#define FACCIA_PROTOCOL_FAPC_H

#include "protocol/fap.h"
#include "protocol/fapc/rangecoder.h"
#include <stddef.h>

enum {
    FAPC_QUALITY_LOSSLESS = 0, /* lossless */
    FAPC_QUALITY_MAX = 31,
    FAPC_QUALITY = 5, /* default: lips of a common head within 0.2 mm, its turns within 0.15 degrees */
    /* Largest magnitude of a value that can be coded; larger ones are limited to it. */
    FAPC_VALUE_MAX = 1 << 24,
    FAPC_FRAMES_MAX = 64, /* in one packet */
    /* A packet never has more bytes than this for each of its frames, and this once more: 66 values, each of
     * at most 45 bits at 10 bits each and 30 even ones, the mask, FAP 1 and FAP 2. */
    FAPC_FRAME_BYTES_MAX = 4200,
};

/* Adaptive probabilities: contexts of the arithmetic coder. */
enum {
    FAPC_WEIGHTS = 7,
    FAPC_GROUPS = 11,
    FAPC_ZEROS = 24,
    FAPC_SIGNS = 15,
    FAPC_CLASSES = 6,
    FAPC_UNARY = 12,
    FAPC_LONG = 32,
    FAPC_CTX_SIGN = (FAP_COUNT + 1) * FAPC_ZEROS,
    FAPC_CTX_SIZE = FAPC_CTX_SIGN + (FAP_COUNT + 1) * FAPC_SIGNS,
    FAPC_CTX_LONG = FAPC_CTX_SIZE + FAPC_GROUPS * FAPC_CLASSES * FAPC_UNARY,
    FAPC_CTX_MASK = FAPC_CTX_LONG + FAPC_GROUPS * FAPC_LONG,
    FAPC_CTX_HIGH = FAPC_CTX_MASK + 3,
    FAPC_CTX_COUNT = FAPC_CTX_HIGH + 10,
};

/* State shared by encoder and decoder: both update it in the same way with every frame. */
struct fapc_state {
    uint8_t quality;  /* 0..31 */
    uint8_t sequence; /* of the next packet, 0..127 */
    struct range_context contexts[FAPC_CTX_COUNT];
    int32_t value[4][FAP_COUNT + 1]; /* of the latest frame and those before it; what a decoder shows */
    int32_t error[FAP_COUNT + 1];    /* of the guesses of the latest frame, in steps */
    int32_t activity[FAP_COUNT + 1]; /* of these errors lately */
    struct fap_frame last;           /* mask, FAP 1 and FAP 2 of the latest frame */
};

struct fapc_encoder {
    struct fapc_state state;
    bool started;
};

struct fapc_decoder {
    struct fapc_state state;
    bool ready; /* has had a packet to begin with, and lost none since */
};

/* The quantiser step of FAP n (3..68) in FAP units. */
int32_t fapc_step(int n, int quality);

/* quality 0 (lossless) to 31. */
void fapc_encoder_init(struct fapc_encoder *encoder, int quality);

/* Encodes the frames into one packet, in order. intra: make it a packet at which a decoder can start (the
 * first one always is). A FAP missing from a frame's mask keeps its value. Returns the number of bytes, 0
 * when cap or count are out of range; cap = (count + 1) * FAPC_FRAME_BYTES_MAX always suffices. */
size_t fapc_encode(struct fapc_encoder *encoder, const struct fap_frame *frames, size_t count, bool intra,
                   uint8_t *out, size_t cap);

void fapc_decoder_init(struct fapc_decoder *decoder);

/* Decodes the `count` frames of a packet. Returns NULL, or the reason of the failure; then all packets up to
 * the next intra packet are refused too. Accepts any bytes; damaged values exceed FAPC_VALUE_MAX by at most
 * two steps. */
const char *fapc_decode(struct fapc_decoder *decoder, const uint8_t *data, size_t size,
                        struct fap_frame *frames, size_t count);

#endif
