/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/life/life_noise.h"

/* Adults at rest breathe 12 to 20 times a minute and take longer to breathe out than in. */
#define BREATH_SECONDS 4.3
#define BREATH_IN 1.5
#define BREATH_OUT 1.9

struct noise noise_of(uint64_t seed, double hz) {
    return (struct noise){.seed = seed, .hz = hz, .whole = -1};
}

void noise_at(struct noise *n, double clock, double out[NOISE_CHANNELS]) {
    double phase = clock * n->hz, whole = floor(phase), x = phase - whole;
    if (whole != n->whole) {
        struct dice before = dice_of(n->seed, DICE_NOISE, (int64_t)whole),
                    after = dice_of(n->seed, DICE_NOISE, (int64_t)whole + 1);
        for (int c = 0; c < NOISE_CHANNELS; c++) {
            n->a[c] = dice_between(&before, -1, 1);
            n->b[c] = dice_between(&after, -1, 1);
        }
        n->whole = whole;
    }
    /* gradient noise: 0 with a random slope at each whole phase */
    double s = x * x * x * (x * (x * 6 - 15) + 10), left = 2 * x * (1 - s), right = 2 * (x - 1) * s;
    for (int c = 0; c < NOISE_CHANNELS; c++)
        out[c] = left * n->a[c] + right * n->b[c];
}

double breath_at(struct breath *b, double clock) {
    double phase = clock / BREATH_SECONDS, whole = floor(phase);
    if (whole != b->whole || b->depth <= 0) {
        struct dice d = dice_of(b->seed, DICE_BREATH, (int64_t)whole);
        double stretch = dice_between(&d, 0.75, 1.1);
        b->whole = whole;
        b->in = BREATH_IN * stretch;
        b->out = BREATH_OUT * stretch;
        b->start = BREATH_SECONDS * whole + dice_roll(&d) * (BREATH_SECONDS - b->in - b->out);
        b->depth = dice_between(&d, 0.6, 1);
    }
    double since = clock - b->start;
    return b->depth *
           (since < b->in ? life_smooth(since / b->in) : 1 - life_smooth((since - b->in) / b->out));
}
