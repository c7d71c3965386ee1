/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FAP interpolation tables. Byte 0 selects: a text and a frame to apply it to; or frames in which to find a
 * table, which must give back what it leaves out. */
#include "protocol/fba/fapfit.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { FRAMES_MAX = 12 };

static void take_frame(struct fuzz_input *in, struct fap_frame *frame) {
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fuzz_u8(in) & 1)
            fap_frame_set(frame, n, (int16_t)fuzz_u16(in));
    frame->mask[0] |= fuzz_u8(in) & 3;
    frame->viseme.select1 = fuzz_u8(in) % 15;
    frame->expression.select1 = fuzz_u8(in) % 7;
    frame->expression.intensity1 = fuzz_u8(in) % 64;
}

static void read_text(struct fuzz_input *in) {
    struct fap_frame frame = {0};
    struct fapfit_error e = {0};
    struct fapfit *fit = malloc(sizeof *fit);
    take_frame(in, &frame);
    size_t size;
    uint8_t *text = fuzz_rest(in, &size);
    struct fap_frame before = frame;
    FUZZ_CHECK(fit);
    if (!fapfit_read((const char *)text, size, fit, &e)) {
        size_t set = fapfit_apply(fit, &frame);
        size_t more = 0;
        for (int n = 1; n <= FAP_COUNT; n++) {
            FUZZ_CHECK(!fap_frame_has(&before, n) ||
                       (fap_frame_has(&frame, n) && frame.value[n] == before.value[n]));
            more += fap_frame_has(&frame, n) && !fap_frame_has(&before, n);
        }
        FUZZ_CHECK(more == set);
        fapfit_free(fit);
    } else {
        FUZZ_CHECK(e.message && e.line && e.column && e.line <= size + 1);
    }
    free(text);
    free(fit);
}

static void find_table(struct fuzz_input *in) {
    struct fap_frame frames[FRAMES_MAX] = {0}, kept[FRAMES_MAX];
    size_t count = 1 + fuzz_below(in, FRAMES_MAX);
    int quant = (int)fuzz_below(in, 32);
    uint8_t left[FAP_MASK_BYTES];
    struct fapfit *fit = malloc(sizeof *fit);
    FUZZ_CHECK(fit);
    for (size_t k = 0; k < count; k++)
        take_frame(in, &frames[k]);
    memcpy(kept, frames, sizeof kept);
    FUZZ_CHECK(!fapfit_find(frames, count, quant, fit));
    fapfit_leave(fit, frames, count, quant, left);
    for (size_t k = 0; k < count; k++) {
        fapfit_apply(fit, &frames[k]);
        FUZZ_CHECK(!memcmp(frames[k].mask, kept[k].mask, sizeof kept[k].mask));
        for (int n = 3; n <= FAP_COUNT; n++) {
            int64_t off = fap_frame_has(&frames[k], n) ? (int64_t)frames[k].value[n] - kept[k].value[n] : 0;
            int64_t most = fap_table[n].quant_step * (quant ? quant : 1) / 2 + 1;
            FUZZ_CHECK(off <= most && -off <= most);
        }
    }
    fapfit_free(fit);
    free(fit);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    if (fuzz_u8(&in) & 1)
        find_table(&in);
    else
        read_text(&in);
    return 0;
}
