/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contents of a face track, shared with placements. */
#include "server/face/track.h"
#include "server/base/mem.h"
#include "server/face/engines/contact.h"
#include "server/face/engines/engine.h"
#include "server/face/engines/fapmap.h"
#include "server/face/expression/expression_layer.h"
#include "server/face/face_layer.h"
#include "server/face/high_level.h"
#include "server/face/life/life.h"
#include "server/face/life/life_internal.h"
#include "server/face/packs/phone_match.h"
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

struct face_track {
    atomic_uint owners;
    struct speech_fapu fapu;
    double end; /* s */
    struct speech_layer speech;
    struct contacts contacts;
    struct openings openings;
    struct visemes visemes;
    bool still;
    struct sentence_expression expression;
};

static const struct phone *first_sound(const struct sentence_audio *u) {
    for (size_t i = 0; i < u->phone_count; i++)
        if (*u->phones[i].ipa)
            return &u->phones[i];
    return NULL;
}

uint32_t lead_in_missing(const struct speech_pack *pack, const struct sentence_audio *u) {
    const struct phone *first = first_sound(u);
    uint32_t needed = (uint32_t)(LEAD_IN_SECONDS * u->sample_rate);
    struct phone_matches found;
    if (!first || first->start >= needed)
        return 0;
    phone_match_find(pack, first->ipa, &found);
    return found.count && found.match[0].phone->contact.kind ? needed - first->start : 0;
}

struct face_placement {
    const struct face_track *track; /* NULL for the idle face */
    struct face_track *shared;
    bool expresses;
    struct face_layer life; /* empty when still */
    double liveliness;      /* strength of the life; 0 = none */
    struct face_layer *layers;
    size_t layer_count, layer_cap;
    struct speech_cursor speech_cursor;
    size_t contact_cursor, opening_cursor, viseme_cursor;
    const double *mouth; /* parameters in mm that replace the engine's; NULL = the engine's */
    struct expression_layer express;
};

/* Initialises everything but the expressions' cache, which is large and set on use. */
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

/* A still face shows the affects of its text, if there are some. */
static void hold(struct face_placement *p) {
    p->expresses = p->track->expression.envelopes.count > 0;
    if (p->expresses)
        expression_layer_begin(&p->express, &p->track->expression, NULL, 0);
}

struct face_placement *face_placement_new(struct face_track *track, const struct sentence_audio *u,
                                          const struct placement_options *options) {
    struct face_placement *p = mem_resize(NULL, sizeof *p);
    begin(p, track);
    p->shared = face_track_share(track);
    if (p->track->still)
        hold(p);
    else if (!options->still)
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

/* Adds life. Upper and lower lid meet after IRISD in total, 1024 FAP units. A blink closes the eyes in any
 * expression, because it replaces the expression's lids in proportion. */
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

static void rest_gaze_and_head(double faps[FAP_COUNT + 1]) {
    for (int n = 23; n <= 30; n++)
        faps[n] = 0;
    for (int n = 48; n <= 50; n++)
        faps[n] = 0;
}

void face_placement_sample(struct face_placement *p, double t, struct fap_frame *frame) {
    face_placement_frame(p, t, 0, frame);
}

void face_placement_frame(struct face_placement *p, double t, double period, struct fap_frame *frame) {
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
        contacts_at(&track->contacts, t, period, &p->contact_cursor, demand);
    }
    if (p->expresses) {
        expression_layer_blend(&p->express, t, demand, faps, &frame->expression);
        frame->mask[0] |= 2; /* FAP 2 */
        if (track->still)
            rest_gaze_and_head(faps);
    }
    for (size_t i = 0; i < p->layer_count; i++)
        p->layers[i].add(p->layers[i].self, t, faps);
    if (p->life.add)
        add_life(&p->life, t, faps);
    /* after all layers, so that none can open a closure or close a vowel */
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

/* Combines two lid movements: a closing one replaces the other. */
static double lids_of(double a, double b, double shut) {
    return b > 0 ? b + a * (1 - fmin(1, b / shut)) : a + b * (1 - fmin(1, fmax(0, a) / shut));
}

/* Replaces life's gaze by a given one, which keeps its target while the head moves. */
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
    if (track->still)
        hold(&alone);
    else
        animate(&alone, NULL, &(struct placement_options){0});
    face_placement_sample(&alone, t, frame);
    free_layer(&alone.life);
}

void face_track_sample(const struct face_track *track, double t, struct fap_frame *frame) {
    face_track_sample_mouth(track, t, NULL, frame);
}

struct face_track *face_track_new(const struct speech_pack *pack, const struct sentence_audio *u,
                                  const struct face_options *options,
                                  void (*warn)(void *ctx, const char *message), void *ctx) {
    struct face_track *track = mem_alloc(sizeof *track);
    struct phone_segments segments;
    phone_segments_from(pack, u, warn, ctx, &segments);
    const struct face_engine *engine = engine_find(options->engine);
    atomic_init(&track->owners, 1);
    track->fapu = pack->fapu;
    track->end = segments.end;
    if (!engine || !engine->speaks(pack))
        engine = engine_find(NULL);
    track->speech = engine->layer(pack, u, &segments);
    if (engine_has_contacts(engine, options->contacts)) {
        contacts_from(&segments, &track->contacts);
        openings_from(&segments, &track->contacts, &track->openings);
    }
    visemes_from(&segments, &track->visemes);
    track->still = options->still;
    sentence_expression_from(u, &segments, options, &track->expression);
    phone_segments_free(&segments);
    return track;
}

struct face_track *face_track_share(struct face_track *track) {
    if (track)
        atomic_fetch_add(&track->owners, 1);
    return track;
}

void face_track_free(struct face_track *track) {
    if (!track || atomic_fetch_sub(&track->owners, 1) > 1)
        return;
    if (track->speech.free)
        track->speech.free(track->speech.self);
    sentence_expression_free(&track->expression);
    contacts_free(&track->contacts);
    openings_free(&track->openings);
    visemes_free(&track->visemes);
    free(track);
}

void face_track_read(const struct face_track *track, const struct fap_frame *frame, double mm[PARAM_COUNT]) {
    fapmap_read(&track->fapu, frame, mm);
}

const struct viseme_key *face_track_visemes(const struct face_track *track, size_t *count) {
    *count = track->visemes.count;
    return track->visemes.keys;
}

bool face_engine_speaks(const char *name, const struct speech_pack *pack) {
    const struct face_engine *engine = engine_find(name);
    return engine && engine->speaks(pack);
}

const char *const *face_engines(void) {
    return engine_names();
}

const char *const *face_engine_ablations(void) {
    return engine_ablations();
}

bool face_engine_contacts(const char *name, enum face_contacts contacts) {
    const struct face_engine *engine = engine_find(name);
    return engine_has_contacts(engine ? engine : engine_find(NULL), contacts);
}
