/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/track.h"
#include "server/base/mem.h"
#include "server/face/engines/contact.h"
#include "server/face/engines/engine.h"
#include "server/face/engines/fapmap.h"
#include "server/face/engines/opening.h"
#include "server/face/engines/viseme.h"
#include "server/face/expression/expression_layer.h"
#include "server/face/face_limits.h"
#include "server/face/life/life.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct face_track {
    struct speech_fapu fapu;
    double end;                       /* s */
    struct face_layer speech;         /* none when idle */
    struct expression_layer *express; /* NULL when still, or nothing to express with */
    struct face_layer life;           /* none when still */
    struct face_layer *layers;
    size_t layer_count, layer_cap;
    struct contacts contacts;
    struct openings openings;
    struct visemes visemes;
    size_t contact_cursor, opening_cursor, viseme_cursor;
};

static void animate(struct face_track *track, const struct sentence_audio *u, const struct phone_segments *g,
                    const struct face_options *options) {
    if (options->still)
        return;
    track->express = expression_layer_new(u, g, options);
    track->life = life_layer(options, u, expression_layer_influence(track->express));
}

struct face_track *face_track_new(const struct speech_pack *pack, const struct sentence_audio *u,
                                  const struct face_options *options,
                                  void (*warn)(void *ctx, const char *message), void *ctx) {
    struct face_track *track = mem_alloc(sizeof *track);
    struct phone_segments gestures;
    phone_segments_from(pack, u, warn, ctx, &gestures);
    const struct face_engine *engine = engine_find(options->engine);
    track->fapu = pack->fapu;
    track->end = gestures.end;
    if (!engine || !engine->speaks(pack))
        engine = engine_find(NULL);
    track->speech = engine->layer(pack, u, &gestures);
    if (engine_has_contacts(engine, options->contacts)) {
        contacts_from(&gestures, &track->contacts);
        openings_from(&gestures, &track->contacts, &track->openings);
    }
    visemes_from(&gestures, &track->visemes);
    animate(track, u, &gestures, options);
    phone_segments_free(&gestures);
    return track;
}

struct face_track *face_track_idle(const struct face_options *options) {
    struct face_track *track = mem_alloc(sizeof *track);
    track->fapu = *face_idle_fapu;
    animate(track, NULL, NULL, options);
    return track;
}

static void free_layer(struct face_layer *layer) {
    if (layer->free)
        layer->free(layer->self);
}

void face_track_free(struct face_track *track) {
    if (!track)
        return;
    free_layer(&track->speech);
    free_layer(&track->life);
    for (size_t i = 0; i < track->layer_count; i++)
        free_layer(&track->layers[i]);
    expression_layer_free(track->express);
    free(track->layers);
    contacts_free(&track->contacts);
    openings_free(&track->openings);
    visemes_free(&track->visemes);
    free(track);
}

void face_track_add(struct face_track *track, struct face_layer layer) {
    track->layers = mem_grow(track->layers, &track->layer_cap, track->layer_count + 1, sizeof layer);
    track->layers[track->layer_count++] = layer;
}

/* Adds life. Lids that meet have moved by IRISD, 1024 FAP units, together; a blink closes the eyes whatever
 * the expression made of the lids: as far as it closes them it replaces that. */
static void add_life(const struct face_layer *layer, double t, double faps[FAP_COUNT + 1]) {
    double expressed[4];
    memcpy(expressed, faps + 19, sizeof expressed);
    memset(faps + 19, 0, sizeof expressed);
    layer->add(layer->self, t, faps);
    for (int side = 0; side < 2; side++) {
        double closed = (faps[19 + side] + faps[21 + side]) / 1024;
        double open = 1 - fmax(0, fmin(1, closed));
        faps[19 + side] += open * expressed[side];
        faps[21 + side] += open * expressed[side + 2];
    }
}

void face_track_sample(struct face_track *track, double t, struct fap_frame *frame) {
    double faps[FAP_COUNT + 1] = {0};
    struct contact_demand demand[CONTACT_TEETH + 1] = {0};
    bool speaks = t > 0 && t < track->end;
    *frame = (struct fap_frame){.viseme = visemes_at(&track->visemes, t, &track->viseme_cursor)};
    frame->mask[0] |= 1; /* FAP 1 */
    if (speaks) {
        track->speech.add(track->speech.self, t, faps);
        contacts_at(&track->contacts, t, &track->contact_cursor, demand);
    }
    if (track->express) {
        expression_layer_blend(track->express, t, demand, faps, &frame->expression);
        frame->mask[0] |= 2; /* FAP 2 */
    }
    for (size_t i = 0; i < track->layer_count; i++)
        track->layers[i].add(track->layers[i].self, t, faps);
    if (track->life.add)
        add_life(&track->life, t, faps);
    /* After all layers, so that none of them can open a closure or close a vowel. */
    if (speaks) {
        openings_show(&track->openings, t, &track->opening_cursor, &track->fapu, faps);
        fapmap_touch(&track->fapu, demand, faps);
    }
    face_limits_apply(&track->fapu, faps, frame);
}
