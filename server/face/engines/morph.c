/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/morph.h"
#include "server/base/mem.h"
#include <stdlib.h>

struct morphing {
    struct morph morph;
    size_t next; /* the first key that comes later than the last instant */
};

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

static void add(void *self, double t, double faps[FAP_COUNT + 1]) {
    struct morphing *m = self;
    if (!m->morph.count)
        return;
    size_t next = m->next = seek(&m->morph, t, m->next);
    const struct morph_key *to = &m->morph.keys[next < m->morph.count ? next : m->morph.count - 1],
                           *from = next ? &m->morph.keys[next - 1] : to;
    double weight = to == from ? 0 : morph_weight(m->morph.ease, (t - from->at) / (to->at - from->at));
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] += from->faps[n] + weight * (to->faps[n] - from->faps[n]);
}

static void morphing_free(void *self) {
    struct morphing *m = self;
    free(m->morph.keys);
    free(m);
}

struct face_layer morph_layer(struct morph *morph) {
    struct morphing *m = mem_alloc(sizeof *m);
    m->morph = *morph;
    *morph = (struct morph){0};
    return (struct face_layer){add, morphing_free, m};
}
