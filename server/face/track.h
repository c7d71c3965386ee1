/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The face of a sentence: tracks, their placement on a clock, limits, and the silence needed before a
 * sentence. */
#ifndef FACCIA_FACE_TRACK_H
#define FACCIA_FACE_TRACK_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/face/face_layer.h"
#include "server/face/packs/shape_table.h"
#include "server/face/packs/speech_pack.h"
#include "server/voice/sentence_audio.h"
#include <stdbool.h>
#include <stdint.h>

struct face_track;

/* Time for lips to reach a contact in the first sound, s, early enough for the one frame at 25 fps that
 * shows it (CONTACT_MIN_SECONDS). People also close their lips before voicing a /b/. */
#define LEAD_IN_SECONDS 0.06

/* Returns how many samples of silence are missing before the sentence, so that a bilabial or labiodental
 * as its first sound has LEAD_IN_SECONDS; else 0. Depends only on the pack, so sound and times are the
 * same for every engine. */
uint32_t lead_in_missing(const struct speech_pack *pack, const struct sentence_audio *u);

/* Options of a track, from the request and the text. */
struct face_options {
    const char *engine; /* NULL = the default, which also replaces an engine that does not support the pack */
    bool still;         /* only the lips move; of the expressions the affects show, without head and gaze */
    enum face_blend blend;
    enum face_contacts contacts;
    const struct expressions *expressions; /* the track takes a reference; NULL = ignore cues */
};

/* Options of a placement: when and how it is played. */
struct placement_options {
    bool still;              /* no life and no mood */
    double life;             /* strength of the life layer, 0..2; 1 = natural, 0 = none */
    uint64_t seed;           /* of the life layer: equal seeds give equal faces */
    double begin;            /* time of the sentence's start on the life clock, s */
    const struct mood *mood; /* borrowed, may change during use; NULL = neutral */
};

/* A placement: one playback of a track on a life clock with its life and mood, or the idle face. Each
 * playback has its own placement of the shared track. */

struct face_placement;

/* Takes a reference to the track; u is its sentence, which may be freed afterwards. Track and u NULL: the
 * idle face, without an end, with times on the life clock. */
struct face_placement *face_placement_new(struct face_track *track, const struct sentence_audio *u,
                                          const struct placement_options *options);
void face_placement_free(struct face_placement *placement);

/* Adds a layer, which the placement owns. */
void face_placement_add(struct face_placement *placement, struct face_layer layer);

/* Computes the face at t seconds (at rest before 0 and after the end), clipped to the FAP ranges and
 * rounded. Fastest with increasing t; the cost does not depend on the sentence's length. */
void face_placement_sample(struct face_placement *placement, double t, struct fap_frame *frame);

/* The same for a frame that stands for `period` s, until the next one: a closure of the lips that lies
 * between two frames is shown in the nearer one. */
void face_placement_frame(struct face_placement *placement, double t, double period, struct fap_frame *frame);

/* The same around a mouth from another source: jaw, lips and tongue are those of the frame, except that
 * the mood moves the corners vertically. Its other FAPs are added to life, scaled by life's strength; if
 * its mask has FAPs 23 to 26, they set the gaze. */
void face_placement_sample_around(struct face_placement *placement, double t, const struct fap_frame *heard,
                                  struct fap_frame *frame);

/* The face track: everything that follows from a sentence alone, from its own time 0: mouth, contacts, the
 * cues' expressions, FAP 1. Immutable, so that it can be cached, shared and replayed by placements. */

struct face_track;

/* Builds the track; never fails. Phones that the pack cannot map are reported through warn (may be NULL)
 * and use the nearest phone's targets. The sentence may be freed afterwards; the pack must outlive the
 * track. */
struct face_track *face_track_new(const struct speech_pack *pack, const struct sentence_audio *u,
                                  const struct face_options *options,
                                  void (*warn)(void *ctx, const char *message), void *ctx);

/* Adds an owner, from any thread. Each owner calls face_track_free. */
struct face_track *face_track_share(struct face_track *track);
void face_track_free(struct face_track *track);

/* Computes the track at t seconds without life and mood. (A placement is faster for many frames.) */
void face_track_sample(const struct face_track *track, double t, struct fap_frame *frame);

/* The same with a given mouth in place of the engine's, or NULL; contacts and openings still apply. */
void face_track_sample_mouth(const struct face_track *track, double t, const double mm[PARAM_COUNT],
                             struct fap_frame *frame);

/* Recovers the parameters from a frame of a still track, mm of the pack's modelled speaker. */
void face_track_read(const struct face_track *track, const struct fap_frame *frame, double mm[PARAM_COUNT]);

/* Returns the keys of FAP 1 in order, owned by the track; the first and last are pauses. */
struct viseme_key;
const struct viseme_key *face_track_visemes(const struct face_track *track, size_t *count);

/* Names for face_options.engine, NULL-terminated. */
const char *const *face_engines(void);

/* Ablations of the default engine, for faccia eval; requests cannot use them. */
const char *const *face_engine_ablations(void);

/* Tells whether the engine exists (NULL = the default, which supports all languages) and the pack has what
 * it needs. */
bool face_engine_speaks(const char *name, const struct speech_pack *pack);

/* Tells whether a track of that engine (NULL = the default) applies contacts. */
bool face_engine_contacts(const char *name, enum face_contacts contacts);

#endif
