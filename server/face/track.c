/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/track.h"
#include "server/base/mem.h"
#include "server/face/contact.h"
#include "server/face/engine.h"
#include "server/face/fapmap.h"
#include "server/face/life.h"
#include "server/face/viseme.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct face_track {
    struct speech_fapu fapu;
    double end; /* s */
    struct face_layer speech;
    struct face_layer *layers;
    size_t layer_count, layer_cap;
    struct contacts contacts;
    struct visemes visemes;
    size_t contact_cursor, viseme_cursor;
};

struct face_track *face_track_new(const struct speech_pack *pack, const struct utterance *u,
                                  const struct face_options *options,
                                  void (*warn)(void *ctx, const char *message), void *ctx) {
    struct face_track *track = mem_alloc(sizeof *track);
    struct gestures gestures;
    gestures_from(pack, u, warn, ctx, &gestures);
    const struct face_engine *engine = engine_find(options->engine);
    track->fapu = pack->fapu;
    track->end = gestures.end;
    if (!engine || !engine->speaks(pack))
        engine = engine_find(NULL);
    track->speech = engine->layer(pack, u, &gestures);
    if (engine->contacts)
        contacts_from(&gestures, &track->contacts);
    visemes_from(&gestures, &track->visemes);
    gestures_free(&gestures);
    if (!options->still)
        face_track_add(track, life_layer(options, u, (struct life_influence){0}));
    return track;
}

void face_track_free(struct face_track *track) {
    if (!track)
        return;
    track->speech.free(track->speech.self);
    for (size_t i = 0; i < track->layer_count; i++)
        if (track->layers[i].free)
            track->layers[i].free(track->layers[i].self);
    free(track->layers);
    contacts_free(&track->contacts);
    visemes_free(&track->visemes);
    free(track);
}

void face_track_add(struct face_track *track, struct face_layer layer) {
    track->layers = mem_grow(track->layers, &track->layer_cap, track->layer_count + 1, sizeof layer);
    track->layers[track->layer_count++] = layer;
}

void face_track_sample(struct face_track *track, double t, struct fap_frame *frame) {
    double faps[FAP_COUNT + 1] = {0};
    bool speaks = t > 0 && t < track->end;
    if (speaks)
        track->speech.add(track->speech.self, t, faps);
    for (size_t i = 0; i < track->layer_count; i++)
        track->layers[i].add(track->layers[i].self, t, faps);
    /* After all layers, so that none of them can open a closure. */
    if (speaks) {
        struct contact_demand demand[CONTACT_TEETH + 1];
        contacts_at(&track->contacts, t, &track->contact_cursor, demand);
        fapmap_touch(&track->fapu, demand, faps);
    }
    fapmap_part_lips(&track->fapu, faps);
    *frame = (struct fap_frame){.viseme = visemes_at(&track->visemes, t, &track->viseme_cursor)};
    frame->mask[0] |= 1; /* FAP 1; FAP 2 is left out: the low-level parameters say it all */
    for (int n = 3; n <= FAP_COUNT; n++)
        fap_frame_set(frame, n, fap_clamp(n, (int32_t)lround(faps[n])));
}
