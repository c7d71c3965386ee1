/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/viseme.h"
#include "server/base/mem.h"
#include "server/face/packs/viseme_id.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* How far into a pause the mouth still comes from or already goes to its neighbour, s. */
#define PAUSE_EDGE 0.1

enum { WHOLE = 63 }; /* blend: all of select1 */

void visemes_from(const struct phone_segments *g, struct visemes *out) {
    out->keys = mem_alloc((g->count + 2) * sizeof *out->keys);
    out->count = 0;
    out->keys[out->count++] = (struct viseme_key){.begin = -1, .end = 0};
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        double middle = (item->start + item->end) / 2;
        struct viseme_key key = {.begin = middle, .end = middle, .from = item->start, .to = item->end};
        key.id = viseme_id_of(item->phone);
        if (item->phone) {
            key.viseme = item->phone->viseme;
            snprintf(key.ipa, sizeof key.ipa, "%s", item->phone->ipa);
        } else {
            key.begin = fmin(middle, item->start + PAUSE_EDGE);
            key.end = fmax(middle, item->end - PAUSE_EDGE);
        }
        out->keys[out->count++] = key;
    }
    out->keys[out->count++] = (struct viseme_key){.begin = g->end, .end = g->end + 1};
}

void visemes_free(struct visemes *visemes) {
    free(visemes->keys);
    *visemes = (struct visemes){0};
}

struct fap_viseme visemes_at(const struct visemes *visemes, double t, size_t *cursor) {
    const struct viseme_key *keys = visemes->keys;
    size_t i = *cursor;
    if (!visemes->count) /* nobody speaks */
        return (struct fap_viseme){.blend = WHOLE};
    while (i > 0 && t < keys[i].begin)
        i--;
    while (i + 1 < visemes->count && t >= keys[i + 1].begin)
        i++;
    *cursor = i;
    struct fap_viseme out = {.select1 = keys[i].viseme, .select2 = keys[i].viseme, .blend = WHOLE};
    if (i + 1 == visemes->count)
        return out;
    out.select2 = keys[i + 1].viseme;
    double x = (t - keys[i].end) / (keys[i + 1].begin - keys[i].end);
    if (x > 0)
        out.blend = (uint8_t)lround(WHOLE * (1 - x * x * (3 - 2 * x)));
    return out;
}
