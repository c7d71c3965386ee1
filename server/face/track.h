/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The face track: the values of all FAPs over the time of one sentence, the sum of its layers, to be sampled
 * at any rate. The face stage hands it to the stream stage. */
#ifndef FACCIA_FACE_TRACK_H
#define FACCIA_FACE_TRACK_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/face/packs/speech_pack.h"
#include "server/voice/sentence_audio.h"

/* A layer adds its part to the values at time t (s from the sentence's start). faps[n] is FAP n in FAP
 * units, as reals. */
struct face_layer {
    void (*add)(void *self, double t, double faps[FAP_COUNT + 1]);
    void (*free)(void *self);
    void *self;
};

/* How expressions share the mouth with speech. */
enum face_blend {
    BLEND_REGIONS,  /* the upper face is free, the mouth gets a limited offset */
    BLEND_WEIGHTED, /* E. Akagunduz 2004, eq. 5.1 to 5.4: weights omega and rho over the whole face */
};

/* Whether lips that must touch do so whatever the engine made (engines/contact.h). */
enum face_contacts {
    CONTACTS_ENGINE, /* as the engine has it: face_engine_contacts */
    CONTACTS_ON,
    CONTACTS_OFF,
};

struct face_options {
    const char
        *engine;   /* NULL = the default one, which also stands in for one that does not speak the pack */
    bool still;    /* lips only: no life, no expressions */
    double life;   /* strength of the life layer, 0..2; 1 = as people are */
    uint64_t seed; /* of the life layer: the same seed gives the same track */
    double begin;  /* time of this sentence's start on the life layer's clock, s */
    enum face_blend blend;
    enum face_contacts contacts;
    const struct expressions *expressions; /* borrowed, must outlive the track; NULL = cues are not shown */
    const struct mood *mood;               /* borrowed, may change while the track is used; NULL = neutral */
};

struct face_track;

/* Builds the track. Phones that the pack cannot map are reported through warn (may be NULL) and get the
 * nearest phone's targets. Never fails: a pack that loaded can serve any sentence. The sentence may be
 * freed afterwards; the pack must outlive the track. */
struct face_track *face_track_new(const struct speech_pack *pack, const struct sentence_audio *u,
                                  const struct face_options *options,
                                  void (*warn)(void *ctx, const char *message), void *ctx);

/* The face while nobody speaks: life and mood only, without an end. Times are on the life layer's clock. */
struct face_track *face_track_idle(const struct face_options *options);

void face_track_free(struct face_track *track);

/* Adds a layer; the track owns it. */
void face_track_add(struct face_track *track, struct face_layer layer);

/* The face at t seconds (any t: before 0 and after the end it is at rest), clamped to the FAP ranges, rounded
 * to FAP units. Cheapest when t does not go backwards. Cost does not depend on the sentence's length. */
void face_track_sample(struct face_track *track, double t, struct fap_frame *frame);

/* The engines that face_options.engine may name, NULL-terminated. */
const char *const *face_engines(void);

/* The default engine with a part left out, for measuring: faccia eval names them, requests cannot. */
const char *const *face_engine_ablations(void);

/* Whether there is an engine of that name (NULL = the default one, which speaks all languages) and the pack
 * has what it needs. */
bool face_engine_speaks(const char *name, const struct speech_pack *pack);

/* Whether a track of that engine (NULL = the default one) has the layer of contacts. */
bool face_engine_contacts(const char *name, enum face_contacts contacts);

#endif
