/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The engines that have one curve for each articulatory parameter: the default one, and what it is compared
 * with. */
#include "server/base/mem.h"
#include "server/face/engines/engine.h"
#include "server/face/engines/fapmap.h"
#include "server/face/engines/targets.h"
#include <stdlib.h>

_Static_assert((int)PARAM_COUNT <= (int)SPEECH_CURSORS, "a cursor for each curve");

struct mouth {
    struct speech_fapu fapu;
    struct curve curves[PARAM_COUNT];
};

static void add(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]) {
    const struct mouth *mouth = self;
    double mm[PARAM_COUNT];
    for (int p = 0; p < PARAM_COUNT; p++) {
        struct curve_cursor at = {.next = cursor->at[p]};
        mm[p] = curve_at(&mouth->curves[p], t, &at);
        cursor->at[p] = at.next;
    }
    fapmap_add(&mouth->fapu, mm, faps);
}

static void articulation_free(void *self) {
    struct mouth *mouth = self;
    for (int p = 0; p < PARAM_COUNT; p++)
        curve_free(&mouth->curves[p]);
    free(mouth);
}

/* Any pack will do. */
static bool articulation_speaks(const struct speech_pack *pack) {
    return pack != NULL;
}

static struct speech_layer articulation_layer(const struct speech_pack *pack, const struct phone_segments *g,
                                              enum targets_function function) {
    struct mouth *mouth = mem_alloc(sizeof *mouth);
    mouth->fapu = pack->fapu;
    targets_curves(pack, g, function, mouth->curves);
    return (struct speech_layer){add, articulation_free, mouth};
}

/* One dominance curve for each articulatory parameter. */
static struct speech_layer dominance(const struct speech_pack *pack, const struct sentence_audio *u,
                                     struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_LOOK_AHEAD);
}

/* The baseline: the function of Cohen and Massaro (1993) as it was, with the same targets and coefficients.
 * No segment is confined by its neighbours and nothing looks after the closures, so fast speech loses them.
 */
static struct speech_layer original(const struct speech_pack *pack, const struct sentence_audio *u,
                                    struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_ORIGINAL);
}

/* The default engine with a part of its function left out, for measuring what that part does. Nobody can ask
 * for them but faccia eval. */
static struct speech_layer without_shape(const struct speech_pack *pack, const struct sentence_audio *u,
                                         struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_NO_SHAPE);
}

static struct speech_layer without_resistance(const struct speech_pack *pack, const struct sentence_audio *u,
                                              struct phone_segments *g) {
    (void)u;
    return articulation_layer(pack, g, TARGETS_NO_RESISTANCE);
}

const struct face_engine engine_dominance = {"dominance", true, articulation_speaks, dominance};
const struct face_engine engine_cohen_massaro = {"cohen-massaro", false, articulation_speaks, original};
const struct face_engine engine_without_shape = {"dominance-no-shape", true, articulation_speaks,
                                                 without_shape};
const struct face_engine engine_without_resistance = {"dominance-no-resistance", true, articulation_speaks,
                                                      without_resistance};
