/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/morph.h"
#include "server/base/mem.h"
#include <stdlib.h>

double morph_weight(enum morph_ease ease, double t) {
    return ease == MORPH_SMOOTH ? t * t * (3 - 2 * t) : t;
}

void morph_add(struct morph *morph, double at, const double *faps) {
    if (morph->count && at <= morph->keys[morph->count - 1].at)
        return;
    morph->keys = mem_grow(morph->keys, &morph->cap, morph->count + 1, sizeof *morph->keys);
    morph->keys[morph->count++] = (struct morph_key){at, faps};
}

static size_t seek(const struct morph *morph, double t, size_t next) {
    if (next && morph->keys[next - 1].at > t)
        next = 0;
    /* A short walk in the usual case; from the start or far ahead, halving. */
    for (int step = 0; step < 4; step++) {
        if (next == morph->count || morph->keys[next].at > t)
            return next;
        next++;
    }
    size_t high = morph->count;
    while (next < high) {
        size_t mid = (next + high) / 2;
        if (morph->keys[mid].at > t)
            high = mid;
        else
            next = mid + 1;
    }
    return next;
}

/* cursor->at[0]: the first key that comes later than the last instant */
static void add(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]) {
    const struct morph *m = self;
    if (!m->count)
        return;
    size_t next = cursor->at[0] = seek(m, t, cursor->at[0]);
    const struct morph_key *to = &m->keys[next < m->count ? next : m->count - 1],
                           *from = next ? &m->keys[next - 1] : to;
    double weight = to == from ? 0 : morph_weight(m->ease, (t - from->at) / (to->at - from->at));
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] += from->faps[n] + weight * (to->faps[n] - from->faps[n]);
}

static void morphing_free(void *self) {
    struct morph *m = self;
    free(m->keys);
    free(m);
}

struct speech_layer morph_layer(struct morph *morph) {
    struct morph *m = mem_alloc(sizeof *m);
    *m = *morph;
    *morph = (struct morph){0};
    return (struct speech_layer){add, morphing_free, m};
}
