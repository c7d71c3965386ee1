/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/placement.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
#include "server/face/expression/expression_layer.h"
#include "server/face/face_limits.h"
#include "server/face/life/life.h"
#include "server/face/life/life_eyes.h"
#include "server/face/track_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct face_placement {
    const struct face_track *track; /* of the idle face: nothing's */
    struct face_track *shared;
    bool expresses;
    struct face_layer life; /* none when still */
    double liveliness;      /* of it; 0 = none */
    struct face_layer *layers;
    size_t layer_count, layer_cap;
    struct speech_cursor speech_cursor;
    size_t contact_cursor, opening_cursor, viseme_cursor;
    const double *mouth; /* mm of the parameters, in place of the engine's; NULL = the engine's */
    struct expression_layer express;
};

/* All but the expressions' memory, which is large and set when it is used. */
static void begin(struct face_placement *p, const struct face_track *track) {
    static const struct face_track nobody;
    memset(p, 0, offsetof(struct face_placement, express));
    p->track = track ? track : &nobody;
}

static void animate(struct face_placement *p, const struct sentence_audio *u,
                    const struct placement_options *options) {
    struct life_influence influence = {0};
    p->expresses = p->track->expression.expressions || options->mood;
    if (p->expresses) {
        expression_layer_begin(&p->express, &p->track->expression, options->mood, options->begin);
        influence = expression_layer_influence(&p->express);
    }
    p->life = life_layer(options, u, influence);
    p->liveliness = options->life;
}

struct face_placement *face_placement_new(struct face_track *track, const struct sentence_audio *u,
                                          const struct placement_options *options) {
    struct face_placement *p = mem_resize(NULL, sizeof *p);
    begin(p, track);
    p->shared = face_track_share(track);
    if (!options->still && !p->track->still)
        animate(p, u, options);
    return p;
}

static void free_layer(struct face_layer *layer) {
    if (layer->free)
        layer->free(layer->self);
}

void face_placement_free(struct face_placement *p) {
    if (!p)
        return;
    free_layer(&p->life);
    for (size_t i = 0; i < p->layer_count; i++)
        free_layer(&p->layers[i]);
    free(p->layers);
    face_track_free(p->shared);
    free(p);
}

void face_placement_add(struct face_placement *p, struct face_layer layer) {
    p->layers = mem_grow(p->layers, &p->layer_cap, p->layer_count + 1, sizeof layer);
    p->layers[p->layer_count++] = layer;
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

void face_placement_sample(struct face_placement *p, double t, struct fap_frame *frame) {
    const struct face_track *track = p->track;
    const struct speech_fapu *fapu = track->speech.add ? &track->fapu : face_idle_fapu;
    double faps[FAP_COUNT + 1] = {0};
    struct contact_demand demand[CONTACT_TEETH + 1] = {0};
    bool speaks = t > 0 && t < track->end;
    *frame = (struct fap_frame){.viseme = visemes_at(&track->visemes, t, &p->viseme_cursor)};
    frame->mask[0] |= 1; /* FAP 1 */
    if (speaks) {
        if (p->mouth)
            fapmap_add(fapu, p->mouth, faps);
        else
            track->speech.add(track->speech.self, t, &p->speech_cursor, faps);
        contacts_at(&track->contacts, t, &p->contact_cursor, demand);
    }
    if (p->expresses) {
        expression_layer_blend(&p->express, t, demand, faps, &frame->expression);
        frame->mask[0] |= 2; /* FAP 2 */
    }
    for (size_t i = 0; i < p->layer_count; i++)
        p->layers[i].add(p->layers[i].self, t, faps);
    if (p->life.add)
        add_life(&p->life, t, faps);
    /* After all layers, so that none of them can open a closure or close a vowel. */
    if (speaks) {
        openings_show(&track->openings, t, &p->opening_cursor, fapu, faps);
        fapmap_touch(fapu, demand, faps);
    }
    face_limits_apply(fapu, faps, frame);
}

/* Jaw, lips, tongue: groups 2, 6 and 8 of MPEG-4. */
static bool is_of_mouth(int n) {
    return fap_table[n].group == 2 || fap_table[n].group == 6 || fap_table[n].group == 8;
}

enum { CORNERS = 4 };
static const int corners[CORNERS] = {12, 13, 59, 60};

/* What two have the lids do: the one that closes them takes the other's part away. */
static double lids_of(double a, double b, double shut) {
    return b > 0 ? b + a * (1 - fmin(1, b / shut)) : a + b * (1 - fmin(1, fmax(0, a) / shut));
}

/* Eyes that somebody else moves give up where life looks, and keep their target while its head moves. */
static void add_heard(const struct fap_frame *heard, double strength, const struct fap_frame *lives,
                      double faps[FAP_COUNT + 1]) {
    for (int n = 19; n <= FAP_COUNT && strength > 0; n++) {
        double more = strength * heard->value[n];
        bool eye = n >= 23 && n <= 26, lid = n >= 19 && n <= 22;
        if (is_of_mouth(n))
            continue;
        if (eye && fap_frame_has(heard, n))
            faps[n] = more - (double)lives->value[n < 25 ? 49 : 48];
        else
            faps[n] = lid ? lids_of(faps[n], more, n < 21 ? LID_UPPER : LID_LOWER) : faps[n] + more;
    }
}

void face_placement_sample_around(struct face_placement *p, double t, const struct fap_frame *heard,
                                  struct fap_frame *frame) {
    double faps[FAP_COUNT + 1] = {0};
    int32_t drawn[CORNERS];
    face_placement_sample(p, t, frame);
    for (int i = 0; i < CORNERS; i++)
        drawn[i] = frame->value[corners[i]];
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] = is_of_mouth(n) ? heard->value[n] : frame->value[n];
    add_heard(heard, fmin(p->liveliness, 1), frame, faps);
    for (int i = 0; i < CORNERS; i++)
        faps[corners[i]] += drawn[i];
    frame->viseme = heard->viseme;
    face_limits_apply(face_idle_fapu, faps, frame);
}

void face_track_sample_mouth(const struct face_track *track, double t, const double mm[PARAM_COUNT],
                             struct fap_frame *frame) {
    struct face_placement alone;
    begin(&alone, track);
    alone.mouth = mm;
    if (!track->still)
        animate(&alone, NULL, &(struct placement_options){0});
    face_placement_sample(&alone, t, frame);
    free_layer(&alone.life);
}

void face_track_sample(const struct face_track *track, double t, struct fap_frame *frame) {
    face_track_sample_mouth(track, t, NULL, frame);
}
