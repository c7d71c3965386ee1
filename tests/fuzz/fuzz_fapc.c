/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Low-bit-rate FAP coding. Byte 0 selects: a file, packets as received over a network, or frames to encode
 * and decode. */
#include "protocol/fapc/fapcfile.h"
#include "server/base/mem.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { FRAMES_MAX = 8, PACKETS_MAX = 16 };

static void read_file(struct fuzz_input *in) {
    struct fapcfile file;
    struct fapcfile_error e = {0};
    size_t size;
    uint8_t *bytes = fuzz_rest(in, &size);
    fapcfile_is(bytes, size);
    if (!fapcfile_read(bytes, size, &file, &e)) {
        FUZZ_CHECK(file.fps > 0 && file.count <= FAPCFILE_FRAMES_MAX);
        fapcfile_free(&file);
    } else {
        FUZZ_CHECK(e.message && e.byte <= size);
    }
    free(bytes);
}

static void check_values(const struct fap_frame *frame) {
    for (int n = 3; n <= FAP_COUNT; n++) {
        int64_t most = FAPC_VALUE_MAX + 2 * (int64_t)fapc_step(n, FAPC_QUALITY_MAX);
        FUZZ_CHECK(frame->value[n] <= most && frame->value[n] >= -most);
    }
}

/* Each is preceded by its number of frames and its size. */
static void read_packets(struct fuzz_input *in) {
    struct fapc_decoder *decoder = mem_alloc(sizeof *decoder);
    struct fap_frame *frames = mem_alloc(FAPC_FRAMES_MAX * sizeof *frames);
    fapc_decoder_init(decoder);
    for (int i = 0; i < PACKETS_MAX && fuzz_left(in); i++) {
        size_t count = fuzz_below(in, FAPC_FRAMES_MAX + 1), size = fuzz_u16(in);
        uint8_t *bytes = fuzz_bytes(in, &size);
        if (!fapc_decode(decoder, bytes, size, frames, count))
            for (size_t f = 0; f < count; f++)
                check_values(&frames[f]);
        free(bytes);
    }
    free(frames);
    free(decoder);
}

static void take_frame(struct fuzz_input *in, struct fap_frame *frame) {
    *frame = (struct fap_frame){0};
    for (uint8_t left = fuzz_u8(in) % 70; left; left--) {
        int n = 3 + fuzz_u8(in) % (FAP_COUNT - 2);
        fap_frame_set(frame, n, fuzz_u8(in) & 1 ? (int32_t)fuzz_u32(in) : (int16_t)fuzz_u16(in));
    }
    uint8_t high = fuzz_u8(in);
    frame->mask[0] |= high & 3;
    if (high & 1)
        frame->viseme = (struct fap_viseme){fuzz_u8(in) % 15, fuzz_u8(in) % 15, fuzz_u8(in) % 64, high & 4};
    if (high & 2)
        frame->expression = (struct fap_expression){fuzz_u8(in) % 7,  fuzz_u8(in) % 64, fuzz_u8(in) % 7,
                                                    fuzz_u8(in) % 64, high & 8,         high & 16};
}

static int32_t limited(int32_t value) {
    return value > FAPC_VALUE_MAX ? FAPC_VALUE_MAX : value < -FAPC_VALUE_MAX ? -FAPC_VALUE_MAX : value;
}

/* FAPs missing from the mask keep their values. */
static void there_and_back(struct fuzz_input *in) {
    static uint8_t bytes[(FRAMES_MAX + 1) * FAPC_FRAME_BYTES_MAX];
    struct fapc_encoder *encoder = mem_alloc(sizeof *encoder);
    struct fapc_decoder *decoder = mem_alloc(sizeof *decoder);
    struct fap_frame frames[FRAMES_MAX], decoded[FRAMES_MAX];
    int quality = (int)fuzz_below(in, FAPC_QUALITY_MAX + 1);
    fapc_encoder_init(encoder, quality);
    fapc_decoder_init(decoder);
    for (int i = 0; i < PACKETS_MAX && fuzz_left(in); i++) {
        uint8_t choice = fuzz_u8(in);
        size_t count = 1 + choice % FRAMES_MAX;
        for (size_t f = 0; f < count; f++)
            take_frame(in, &frames[f]);
        size_t size = fapc_encode(encoder, frames, count, choice & 64, bytes, sizeof bytes);
        FUZZ_CHECK(size && !fapc_decode(decoder, bytes, size, decoded, count));
        for (size_t f = 0; f < count; f++) {
            check_values(&decoded[f]);
            for (int n = 3; n <= FAP_COUNT && !quality; n++)
                FUZZ_CHECK(!fap_frame_has(&frames[f], n) ||
                           decoded[f].value[n] == limited(frames[f].value[n]));
        }
    }
    free(decoder);
    free(encoder);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    switch (fuzz_below(&in, 3)) {
    case 0:
        read_file(&in);
        break;
    case 1:
        read_packets(&in);
        break;
    default:
        there_and_back(&in);
    }
    return 0;
}
