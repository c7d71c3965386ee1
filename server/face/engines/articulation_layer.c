/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/articulation_layer.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
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

bool articulation_speaks(const struct speech_pack *pack) {
    return pack != NULL;
}

struct speech_layer articulation_layer(const struct speech_pack *pack, const struct phone_segments *g,
                                       enum targets_function function) {
    struct mouth *mouth = mem_alloc(sizeof *mouth);
    mouth->fapu = pack->fapu;
    targets_curves(pack, g, function, mouth->curves);
    return (struct speech_layer){add, articulation_free, mouth};
}
