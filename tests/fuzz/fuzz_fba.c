/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FBA bitstreams. Byte 0 selects: a file; or frames to write and read again. */
#include "protocol/fba/fba.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES_MAX = 24, READ_MAX = 4096 };

static void read_file(struct fuzz_input *in) {
    struct fba_limits limits = {.frames = READ_MAX};
    struct fba_file file;
    struct fba_error e = {0};
    size_t size;
    uint8_t *bytes = fuzz_rest(in, &size);
    fba_is(bytes, size);
    if (!fba_read(bytes, size, &limits, &file, &e)) {
        FUZZ_CHECK(file.fps > 0 && file.fps <= FBA_FPS_MAX + 1 && file.count && file.count <= READ_MAX);
        for (size_t i = 0; i < file.count; i++)
            FUZZ_CHECK(file.frames[i].viseme.select1 <= 14 && file.frames[i].expression.intensity2 <= 63);
        fba_free(&file);
    } else {
        FUZZ_CHECK(e.message && e.byte <= size && e.bit >= 0 && e.bit < 8);
    }
    free(bytes);
}

static void take_frame(struct fuzz_input *in, struct fap_frame *frame) {
    uint8_t how = fuzz_u8(in);
    if (!(how & 1)) {
        *frame = (struct fap_frame){0};
        for (int i = 0; i < FAP_MASK_BYTES; i++)
            frame->mask[i] = fuzz_u8(in);
        frame->mask[FAP_MASK_BYTES - 1] &= 0x0f;
    }
    for (uint8_t left = fuzz_u8(in) % 70; left; left--) {
        int n = 3 + fuzz_u8(in) % (FAP_COUNT - 2);
        frame->value[n] = how & 2 ? (int32_t)fuzz_u32(in) : (int16_t)fuzz_u16(in);
    }
    frame->viseme = (struct fap_viseme){fuzz_u8(in) % 15, how % 15, how % 64, how >> 7};
    frame->expression = (struct fap_expression){how % 7, fuzz_u8(in) % 64, how / 37, how / 4, how >> 7, 0};
}

/* What is within the range of the stream comes back within half a step, the rest within the range. */
static void check_frame(const struct fap_frame *a, const struct fap_frame *b, int quant, bool limited) {
    FUZZ_CHECK(!memcmp(a->mask, b->mask, sizeof a->mask));
    for (int n = 3; n <= FAP_COUNT && !limited; n++) {
        int64_t step = quant ? fap_table[n].quant_step * quant : 1;
        int64_t off = fap_frame_has(a, n) ? (int64_t)a->value[n] - b->value[n] : 0;
        FUZZ_CHECK(off <= step / 2 && -off <= step / 2);
    }
    FUZZ_CHECK(quant > 1 || !fap_frame_has(a, 1) || !memcmp(&a->viseme, &b->viseme, sizeof a->viseme));
}

static void there_and_back(struct fuzz_input *in) {
    struct fap_frame frames[FRAMES_MAX] = {0};
    struct fba_options options = {.quant = (int)fuzz_below(in, FBA_QUANT_MAX + 1)};
    double fps = (1 + fuzz_u8(in)) / 1.1;
    size_t count = 1 + fuzz_below(in, FRAMES_MAX);
    options.intra_seconds = (1 + fuzz_u8(in)) / 32.0;
    for (size_t i = 0; i < count; i++) {
        frames[i] = frames[i ? i - 1 : 0];
        take_frame(in, &frames[i]);
    }
    struct fba_written written;
    struct fba_file file;
    struct fba_error e;
    FUZZ_CHECK(!fba_write(frames, count, fps, &options, &written));
    FUZZ_CHECK(fba_is(written.data, written.size));
    FUZZ_CHECK(!fba_read(written.data, written.size, NULL, &file, &e));
    FUZZ_CHECK(file.count == count && fabs(file.fps - fps) < 0.04);
    for (size_t i = 0; i < count; i++)
        check_frame(&frames[i], &file.frames[i], options.quant, written.limited);
    fba_free(&file);
    free(written.data);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    if (fuzz_u8(&in) & 1)
        there_and_back(&in);
    else
        read_file(&in);
    return 0;
}
