/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How fast the lips move, how smoothly, and whether they pass through each other. */
#include "server/eval/eval.h"
#include "server/face/engines/fapmap.h"
#include <math.h>

static void measure_frames(struct eval *e, const struct eval_input *in, double end) {
    double gaps[4] = {0}; /* the last four, newest first */
    int known = 0;
    for (double k = ceil(in->start * in->fps - 1e-9); k / in->fps - in->start <= end; k++) {
        struct fap_frame frame;
        in->face.sample(in->face.self, k / in->fps - in->start, &frame);
        for (int i = 3; i > 0; i--)
            gaps[i] = gaps[i - 1];
        gaps[0] = eval_gap(in->pack, &frame);
        known++;
        if (known >= 2)
            e->speed = fmax(e->speed, fabs(gaps[0] - gaps[1]) * in->fps);
        if (known >= 4)
            e->jerk = fmax(e->jerk, fabs(gaps[0] - 3 * gaps[1] + 3 * gaps[2] - gaps[3]) * pow(in->fps, 3));
    }
}

void eval_motion(struct eval *e, const struct eval_input *in, const struct phone_segments *g) {
    static const int pairs[3][2] = {{4, 5}, {8, 10}, {9, 11}}; /* middle, left, right */
    double unit = in->pack->fapu.mns / 1024;
    measure_frames(e, in, g->end);
    for (double t = 0; t <= g->end; t += EVAL_FINE_STEP) {
        struct fap_frame frame;
        in->face.sample(in->face.self, t, &frame);
        for (int i = 0; i < 3; i++) {
            /* both values are rounded: one unit is no overlap */
            double overlap =
                (frame.value[pairs[i][0]] + frame.value[pairs[i][1]] - 1) * unit - FAPMAP_MAX_PRESS;
            e->overlap = fmax(e->overlap, overlap);
        }
    }
}
