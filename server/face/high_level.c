/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FAP 1 and 2: visemes and their blend for simple decoders, and their expansion to other FAPs. */
#include "server/face/high_level.h"
#include "server/base/mem.h"
#include "server/expression/recipe.h"
#include "server/face/packs/shape_table.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Transition into and out of a pause, s. */
#define PAUSE_EDGE 0.1

enum { BLEND_WHOLE = 63 }; /* blend: only select1 */

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
    if (!visemes->count) /* no speech */
        return (struct fap_viseme){.blend = BLEND_WHOLE};
    while (i > 0 && t < keys[i].begin)
        i--;
    while (i + 1 < visemes->count && t >= keys[i + 1].begin)
        i++;
    *cursor = i;
    struct fap_viseme out = {.select1 = keys[i].viseme, .select2 = keys[i].viseme, .blend = BLEND_WHOLE};
    if (i + 1 == visemes->count)
        return out;
    out.select2 = keys[i + 1].viseme;
    double x = (t - keys[i].end) / (keys[i + 1].begin - keys[i].end);
    if (x > 0)
        out.blend = (uint8_t)lround(BLEND_WHOLE * (1 - x * x * (3 - 2 * x)));
    return out;
}

enum { VISEMES = 14, WHOLE = 63 };

struct face_high_level {
    double visemes[VISEMES + 1][FAP_COUNT + 1]; /* FAP units; 0 is the mouth at rest */
    double basics[BASIC_COUNT + 1][FAP_COUNT + 1];
};

/* One example phone for each viseme: p, f, th, t, k, sh, s, n, r, and the five vowels. */
static const char *const phones[VISEMES + 1] = {NULL, "p", "f", "θ", "t", "k", "ʃ", "s",
                                                "n",  "r", "a", "e", "i", "o", "u"};

struct face_high_level *face_high_level_new(const struct speech_pack *pack,
                                            const struct expressions *expressions) {
    struct face_high_level *high = mem_alloc(sizeof *high);
    for (size_t i = 1; i <= VISEMES; i++) {
        const struct speech_phone *phone =
            pack ? speech_pack_phone(pack, phones[i], strlen(phones[i])) : NULL;
        if (phone && phone->group)
            shape_of_phone(pack, phone, high->visemes[i]);
    }
    for (size_t i = 0; i < expressions_count(expressions); i++) {
        const struct expression *x = expressions_at(expressions, i);
        for (size_t k = 0; x->basic && k < x->pose.count; k++)
            high->basics[x->basic][x->pose.faps[k].fap] = x->pose.faps[k].value;
    }
    return high;
}

void face_high_level_free(struct face_high_level *high) {
    free(high);
}

static const double *chosen(const double (*table)[FAP_COUNT + 1], size_t last, uint8_t select) {
    return table[select <= last ? select : 0];
}

static double share(uint8_t part) {
    return (part < WHOLE ? part : WHOLE) / (double)WHOLE;
}

static void expand(const struct face_high_level *high, const bool *moved, struct fap_frame *frame) {
    const struct fap_viseme *v = &frame->viseme;
    const struct fap_expression *x = &frame->expression;
    double blend = share(v->blend);
    const double *viseme1 = chosen(high->visemes, VISEMES, v->select1),
                 *viseme2 = chosen(high->visemes, VISEMES, v->select2),
                 *basic1 = chosen(high->basics, BASIC_COUNT, x->select1),
                 *basic2 = chosen(high->basics, BASIC_COUNT, x->select2);
    bool visemes = fap_frame_has(frame, 1), basics = fap_frame_has(frame, 2);
    for (int n = 3; n <= FAP_COUNT; n++) {
        double value = visemes ? blend * viseme1[n] + (1 - blend) * viseme2[n] : 0;
        if (basics)
            value += share(x->intensity1) * basic1[n] + share(x->intensity2) * basic2[n];
        if (value != 0 && !moved[n])
            fap_frame_set(frame, n, fap_clamp(n, (int32_t)lround(value)));
    }
}

void face_high_level_expand(const struct face_high_level *high, struct fap_frame *frames, size_t count) {
    bool moved[FAP_COUNT + 1] = {0};
    if (!high)
        return;
    for (size_t i = 0; i < count; i++)
        for (int n = 3; n <= FAP_COUNT; n++)
            moved[n] |= fap_frame_has(&frames[i], n) && frames[i].value[n];
    for (size_t i = 0; i < count; i++)
        expand(high, moved, &frames[i]);
}
