/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/face_limits.h"
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <string.h>

/* Upper and lower lid meet after IRISD in all: 1024 FAP units. */
#define LIDS_MEET 1024

static const struct speech_fapu fapu_of_models = {.irisd = 11.7, .es = 62, .ens = 42, .mns = 21, .mw = 50};
const struct speech_fapu *const face_idle_fapu = &fapu_of_models;

static void part_lids(double faps[FAP_COUNT + 1]) {
    for (int upper = 19; upper <= 20; upper++)
        faps[upper] -= fmax(0, faps[upper] + faps[upper + 2] - LIDS_MEET);
}

void face_limits_apply(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1], struct fap_frame *frame) {
    fapmap_part_lips(fapu, faps);
    part_lids(faps);
    for (int n = 3; n <= FAP_COUNT; n++) {
        frame->value[n] = 0;
        if (faps[n] == 0) /* many, and always within the limits */
            continue;
        double value = faps[n] < fap_table[n].min   ? fap_table[n].min
                       : faps[n] > fap_table[n].max ? fap_table[n].max
                                                    : faps[n];
        frame->value[n] = (int32_t)(value + (value < 0 ? -0.5 : 0.5));
    }
    frame->mask[0] |= 0xfc; /* FAPs 3 to 8 */
    memset(frame->mask + 1, 0xff, FAP_MASK_BYTES - 2);
    frame->mask[FAP_MASK_BYTES - 1] |= 0x0f; /* 65 to 68 */
}
