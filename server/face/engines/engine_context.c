/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visemes that depend on their context, each reached in the middle of its phone, and a smooth way between
 * them: no dominance, no look-ahead beyond two sounds. */
#include "server/face/engines/engine.h"
#include "server/face/engines/morph.h"
#include "server/face/packs/context_table.h"

static size_t sound_at(const struct context_table *table, const struct phone_segments *g, size_t i,
                       long offset) {
    long at = (long)i + offset;
    return at < 0 || at >= (long)g->count ? (size_t)CONTEXT_SILENCE
                                          : context_sound(table, g->items[at].phone);
}

/* A pause that is long enough for it holds the rest, so that the mouth does not wait half the pause to close.
 */
static void add_pause(struct morph *morph, const struct phone_segment *g, const struct speech_rest *rest,
                      const double *faps) {
    if (g->end - g->start > rest->reach + rest->leave) {
        morph_add(morph, g->start + rest->reach, faps);
        morph_add(morph, g->end - rest->leave, faps);
    } else {
        morph_add(morph, (g->start + g->end) / 2, faps);
    }
}

static struct speech_layer layer(const struct speech_pack *pack, const struct sentence_audio *u,
                                 struct phone_segments *g) {
    (void)u;
    const struct context_table *table = pack->visemes;
    const double *rest = table->shapes.items[table->silence].faps;
    struct morph morph = {.ease = MORPH_SMOOTH};
    morph_add(&morph, 0, rest);
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone) {
            add_pause(&morph, item, &pack->rest, rest);
            continue;
        }
        size_t sounds[CONTEXT_WINDOW];
        for (size_t k = 0; k < CONTEXT_WINDOW; k++)
            sounds[k] = sound_at(table, g, i, (long)k - CONTEXT_WINDOW / 2);
        morph_add(&morph, (item->start + item->end) / 2, /* (4.1) */
                  table->shapes.items[context_shape(table, sounds)].faps);
    }
    morph_add(&morph, g->end, rest);
    return morph_layer(&morph);
}

static bool speaks(const struct speech_pack *pack) {
    return pack->visemes != NULL;
}

const struct face_engine engine_context = {"context", true, speaks, layer};
