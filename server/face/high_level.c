/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/high_level.h"
#include "server/base/mem.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include "server/face/packs/shape.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VISEMES = 14, WHOLE = 63 };

struct face_high_level {
    double visemes[VISEMES + 1][FAP_COUNT + 1]; /* FAP units; 0 is the mouth at rest */
    double basics[BASIC_COUNT + 1][FAP_COUNT + 1];
};

/* One phone of each viseme's examples: p, f, th, t, k, sh, s, n, r, and the five vowels. */
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
