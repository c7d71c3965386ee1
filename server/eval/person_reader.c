/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/person_reader.h"
#include <math.h>

/* Lips and jaw; the tongue is not for a lip reader, and the aperture is the sum of two others. */
enum { SEEN = PARAM_EM + 1, PLACES = 3 };
_Static_assert(PLACES *SEEN <= READER_FEATURES, "the features have room");
#define STEP 0.01 /* s, between the instants of mean and deviation */

struct norm {
    double mean, deviation;
};

static struct norm norm_of(const struct person_mouth *mouth, int measure) {
    double sum = 0, squares = 0, n = 0;
    const struct phone_segments *g = mouth->segments;
    for (size_t i = 0; i < g->count; i++)
        for (double t = g->items[i].start; g->items[i].phone && t < g->items[i].end; t += STEP) {
            double y = mouth->at(mouth->ctx, measure, t);
            sum += y;
            squares += y * y;
            n++;
        }
    double mean = n > 0 ? sum / n : 0, variance = n > 0 ? squares / n - mean * mean : 0;
    return (struct norm){mean, variance > 1e-12 ? sqrt(variance) : 1};
}

static double middle(const struct phone_segments *g, size_t i) {
    return (g->items[i].start + g->items[i].end) / 2;
}

void person_reader_add(struct lip_reader *reader, int half, const struct person_mouth *mouth,
                       const bool use[PERSON_MEASURES]) {
    const struct phone_segments *g = mouth->segments;
    struct norm norms[SEEN];
    for (int p = 0; p < SEEN; p++)
        norms[p] = use[p] ? norm_of(mouth, p) : (struct norm){0, 1};
    for (size_t i = 0; i < g->count; i++) {
        if (!g->items[i].phone)
            continue;
        struct lip_reader_sample sample = {.class = g->items[i].phone->group};
        double at[PLACES] = {i ? middle(g, i - 1) : g->items[i].start, middle(g, i),
                             i + 1 < g->count ? middle(g, i + 1) : g->items[i].end};
        for (int place = 0; place < PLACES; place++)
            for (int p = 0; p < SEEN; p++)
                if (use[p])
                    sample.features[place * SEEN + p] =
                        (float)((mouth->at(mouth->ctx, p, at[place]) - norms[p].mean) / norms[p].deviation);
        lip_reader_add(reader, half, &sample);
    }
}
