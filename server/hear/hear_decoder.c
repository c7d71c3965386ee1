/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hear_decoder.h"

/* As long as it is that likely a closure goes on. */
#define CLOSED_HOLD 0.3F
/* What is that likely begins at once, all else once it has lasted so many frames. */
#define SURE 0.75F
enum { LEAST_FRAMES = 2, CONTACT_FRAMES = 4 };

static bool touches(enum hear_class class) {
    return class == HEAR_CLOSED || class == HEAR_TEETH;
}

static enum hear_class best(const float likely[HEAR_CLASSES]) {
    int found = HEAR_SILENCE;
    for (int i = 1; i < HEAR_CLASSES; i++)
        if (likely[i] > likely[found])
            found = i;
    return (enum hear_class)found;
}

void hear_decoder_begin(struct hear_decoder *d) {
    *d = (struct hear_decoder){.now = {.class = HEAR_SILENCE}};
}

bool hear_decoder_step(struct hear_decoder *d, const float likely[HEAR_CLASSES], struct hear_phone *ended) {
    enum hear_class heard = best(likely);
    struct hear_phone *now = &d->now;
    uint32_t frame = now->end++, age = frame - now->start;
    bool held = touches(now->class) && (age < CONTACT_FRAMES || likely[now->class] > CLOSED_HOLD);
    now->likely += likely[now->class];
    if (heard == now->class || (held && !touches(heard))) {
        d->since = now->end;
        return false;
    }
    if (d->since >= frame || d->next != heard) {
        d->since = frame;
        d->next = heard;
        d->next_likely = 0;
        d->now_likely = now->likely - likely[now->class];
    }
    d->next_likely += likely[heard];
    if (frame - d->since + 1 < LEAST_FRAMES && !touches(heard) && likely[heard] < SURE)
        return false;
    *ended = *now;
    ended->end = d->since;
    ended->likely = d->now_likely;
    *now = (struct hear_phone){heard, d->since, frame + 1, d->next_likely};
    d->since = now->end;
    return ended->end > ended->start;
}
