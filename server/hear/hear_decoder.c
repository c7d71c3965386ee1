/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hear_decoder.h"
#include <string.h>

/* As long as it is that likely a closure goes on. */
#define CLOSED_HOLD 0.3F
/* What is that likely begins at once, all else once it has lasted so many frames. */
#define SURE 0.75F
enum { LEAST_FRAMES = 2, CONTACT_FRAMES = 4 };
/* A missed closure is worse than one too many, and teeth on the lip are mostly missed: so much more they
 * count. models/hear/README.md has what was tried. */
static const float counts[HEAR_CLASSES] = {[HEAR_CLOSED] = 1.4F, [HEAR_TEETH] = 2};

static bool touches(enum hear_class class) {
    return class == HEAR_CLOSED || class == HEAR_TEETH;
}

static enum hear_class best(const float likely[HEAR_CLASSES]) {
    int found = HEAR_SILENCE;
    float most = likely[HEAR_SILENCE];
    for (int i = 1; i < HEAR_CLASSES; i++) {
        float weighed = counts[i] > 0 ? counts[i] * likely[i] : likely[i];
        if (weighed > most) {
            most = weighed;
            found = i;
        }
    }
    return (enum hear_class)found;
}

static void add(double sums[HEAR_CLASSES], const float likely[HEAR_CLASSES]) {
    for (int i = 0; i < HEAR_CLASSES; i++)
        sums[i] += (double)likely[i];
}

void hear_decoder_begin(struct hear_decoder *d) {
    *d = (struct hear_decoder){.now = {.class = HEAR_SILENCE}};
}

bool hear_decoder_step(struct hear_decoder *d, const float likely[HEAR_CLASSES], struct hear_phone *ended) {
    enum hear_class heard = best(likely);
    struct hear_phone *now = &d->now;
    uint32_t frame = now->end++, age = frame - now->start;
    bool held = touches(now->class) && (age < CONTACT_FRAMES || likely[now->class] > CLOSED_HOLD);
    bool stays = heard == now->class || (held && !touches(heard));
    if (!stays && (d->since >= frame || d->next != heard)) {
        d->since = frame;
        d->next = heard;
        memset(d->next_likely, 0, sizeof d->next_likely);
        memcpy(d->before, now->likely, sizeof d->before);
    }
    add(now->likely, likely);
    if (stays) {
        d->since = now->end;
        return false;
    }
    add(d->next_likely, likely);
    if (frame - d->since + 1 < LEAST_FRAMES && !touches(heard) && likely[heard] < SURE)
        return false;
    *ended = *now;
    ended->end = d->since;
    memcpy(ended->likely, d->before, sizeof d->before);
    *now = (struct hear_phone){heard, d->since, frame + 1, {0}};
    memcpy(now->likely, d->next_likely, sizeof now->likely);
    d->since = now->end;
    return ended->end > ended->start;
}
