/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recorded faces: a Live Link Face CSV, curves of lips, or after a zero byte packets of the VMC protocol,
 * of Live Link Face or of iFacialMocap, each with its size before it (two bytes). */
#include "protocol/fap.h"
#include "server/cli/face_capture.h"
#include "server/cli/puppet_packet.h"
#include "tests/fuzz/fuzz.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_MAX = 64 };

struct received {
    struct capture_row rows[ROWS_MAX];
    size_t count;
};

static void on_face(void *ctx, const struct puppet_face *face) {
    struct received *r = ctx;
    FUZZ_CHECK(isfinite(face->time) && isfinite(face->head.head_yaw) && isfinite(face->head.head_pitch) &&
               isfinite(face->head.head_roll));
    for (int i = 0; i < ARKIT_SHAPES; i++)
        FUZZ_CHECK(isfinite(face->weights[i]));
    if (r->count == ROWS_MAX)
        return;
    struct capture_row *row = &r->rows[r->count];
    *row = (struct capture_row){.time = (double)r->count / 30, .head = face->head};
    memcpy(row->weights, face->weights, sizeof row->weights);
    r->count++;
}

/* Every frame is within the limits of its FAPs. */
static void check(struct fapfile *face) {
    FUZZ_CHECK(face->count > 0 && face->fps > 0);
    for (size_t k = 0; k < face->count; k++)
        for (int fap = 3; fap <= FAP_COUNT; fap++)
            if (fap_frame_has(&face->frames[k], fap))
                FUZZ_CHECK(face->frames[k].value[fap] >= -100000000 &&
                           face->frames[k].value[fap] <= 100000000);
    fapfile_free(face);
}

static void packets(const uint8_t *data, size_t size) {
    static struct received received;
    struct puppet_face state = {0};
    struct fapfile face = {0};
    memset(&received, 0, sizeof received);
    for (size_t at = 0; size - at >= 2;) {
        size_t length = (size_t)data[at] | (size_t)data[at + 1] << 8;
        at += 2;
        length = length < size - at ? length : size - at;
        puppet_packet(&state, data + at, length, on_face, &received);
        at += length;
    }
    if (received.count && !capture_frames(received.rows, received.count, 25, &face))
        check(&face);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct capture_error error = {0};
    struct fapfile face = {0};
    if (size && !*data)
        packets(data + 1, size - 1);
    else if (lip_capture_is((const char *)data, size)
                 ? lip_capture_read((const char *)data, size, 0, &face, &error)
                 : capture_read((const char *)data, size, 0, 5, &face, &error))
        FUZZ_CHECK(error.message && *error.message);
    else
        check(&face);
    return 0;
}
