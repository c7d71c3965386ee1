/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/sound/mixdown.h"
#include <math.h>

/* Correlations below which a channel counts as inverted, and above which it no longer does: beyond what a
 * wide stereo recording reaches. */
#define INVERTED (-0.7)
#define UPRIGHT 0.0
/* Decay per frame: about half a second at 44,100 frames a second. */
#define KEEP (1 - 1.0 / 20000)
/* Frames needed to judge a channel: 5 to 30 ms. */
enum { HEARD_LEAST = 256 };
#define LOUDEST 16.0 /* float files may contain anything; keeps sums of squares finite */

static double sane(float x) {
    return isfinite(x) ? fmax(-LOUDEST, fmin(LOUDEST, (double)x)) : 0;
}

double mixdown_frame(struct mixdown *m, const float *frame, unsigned channels) {
    double sum = sane(frame[0]);
    for (unsigned c = 1; c < channels; c++) {
        double x = sane(frame[c]);
        m->channels[c].energy = KEEP * m->channels[c].energy + x * x;
        m->channels[c].rest = KEEP * m->channels[c].rest + sum * sum;
        m->channels[c].with = KEEP * m->channels[c].with + x * sum;
        if (m->channels[c].heard < HEARD_LEAST) {
            m->channels[c].heard += x * sum != 0;
        } else {
            double limit = m->channels[c].inverted ? UPRIGHT : INVERTED;
            m->channels[c].inverted =
                m->channels[c].with < limit * sqrt(m->channels[c].energy * m->channels[c].rest);
        }
        sum += m->channels[c].inverted ? -x : x;
    }
    return sum / channels;
}
