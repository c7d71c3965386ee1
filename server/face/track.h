/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a mouth needs before a sentence is heard. */
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

/* Lips that are to meet in the first sound have to be on their way before it: to the contact that one frame
 * of 25 a second shows, wherever it falls (CONTACT_MIN_SECONDS), s. People close theirs before they voice a
 * /b/, too. */
#define LEAD_IN_SECONDS 0.06

/* How many samples of silence are missing before the sentence, so that its first sound, where that is a
 * bilabial or a labiodental, has LEAD_IN_SECONDS before it; else 0. Asks the pack alone: sound and times are
 * the same for every engine. */
uint32_t lead_in_missing(const struct speech_pack *pack, const struct sentence_audio *u);

/* From the sum of all layers to a frame: what flesh cannot do is taken back. */

struct speech_fapu;

/* Keeps lips and lids from passing through each other, rounds and limits; sets FAPs 3 to 68 of the frame. */
void face_limits_apply(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1], struct fap_frame *frame);

/* The FAPUs of a face that does not speak: those of the speakers on whom the languages were modelled. */
extern const struct speech_fapu *const face_idle_fapu;

/* What a face track is made with, and what it is played with. */

/* Of a face track: what is said, and how the author wants it shown. */
struct face_options {
    const char
        *engine; /* NULL = the default one, which also stands in for one that does not speak the pack */
    bool still;  /* lips only: no expressions */
    enum face_blend blend;
    enum face_contacts contacts;
    const struct expressions *expressions; /* the track takes a share; NULL = cues are not shown */
};

/* Of a placement: when it is played, and by whom. */
struct placement_options {
    bool still;              /* no life and no mood */
    double life;             /* strength of the life layer, 0..2; 1 = as people are, 0 = none */
    uint64_t seed;           /* of the life layer: the same seed gives the same face */
    double begin;            /* time of the sentence's start on the life layer's clock, s */
    const struct mood *mood; /* borrowed, may change while the placement is used; NULL = neutral */
};

/* A placement: a face track as it is played once, on a life clock, with a life and a mood
 * of its own; or the face while nobody speaks. What is played again, later or by another is placed anew, and
 * nothing is made twice but this. */

struct face_placement;

/* The track is shared; u is the sentence that it was made of, which may be freed afterwards. Track and u =
 * NULL: nobody speaks, without an end, and times are on the life clock. */
struct face_placement *face_placement_new(struct face_track *track, const struct sentence_audio *u,
                                          const struct placement_options *options);
void face_placement_free(struct face_placement *placement);

/* Adds a layer; the placement owns it. */
void face_placement_add(struct face_placement *placement, struct face_layer layer);

/* The face at t seconds (any t: before 0 and after the end it is at rest), clamped to the FAP ranges, rounded
 * to FAP units. Cheapest when t does not go backwards. Cost does not depend on the sentence's length. */
void face_placement_sample(struct face_placement *placement, double t, struct fap_frame *frame);

/* Around a mouth that somebody else moves: its jaw, lips and tongue are those of that frame, but that the
 * mood draws the corners up or down, which opens and closes nothing. What the rest of that frame does is
 * added to life, as strong as life is; where it has the eyes (FAPs 23 to 26 of its mask) they look where it
 * says. */
void face_placement_sample_around(struct face_placement *placement, double t, const struct fap_frame *heard,
                                  struct fap_frame *frame);

/* The face track: what follows from a sentence alone, over the time from its own zero: the mouth, what lips
 * must touch, the cues' expressions, FAP 1. Immutable, so that it can be kept, shared and played again;
 * placement.h plays it. */

struct face_track;

/* Builds the track. Phones that the pack cannot map are reported through warn (may be NULL) and get the
 * nearest phone's targets. Never fails: a pack that loaded can serve any sentence. The sentence may be
 * freed afterwards; the pack must outlive the track. */
struct face_track *face_track_new(const struct speech_pack *pack, const struct sentence_audio *u,
                                  const struct face_options *options,
                                  void (*warn)(void *ctx, const char *message), void *ctx);

/* One more owner, in any thread. Each calls face_track_free. */
struct face_track *face_track_share(struct face_track *track);
void face_track_free(struct face_track *track);

/* The track alone at t seconds, as a placement without life and mood has it (placement.h, which is cheaper
 * for many frames). */
void face_track_sample(const struct face_track *track, double t, struct fap_frame *frame);

/* The same with a mouth that somebody else knows, in place of the engine's, or NULL: the track's contacts and
 * openings hold for it, too. */
void face_track_sample_mouth(const struct face_track *track, double t, const double mm[PARAM_COUNT],
                             struct fap_frame *frame);

/* What the parameters are in a frame of a still track, mm of the speaker that the pack models. */
void face_track_read(const struct face_track *track, const struct fap_frame *frame, double mm[PARAM_COUNT]);

/* What FAP 1 shows, sound by sound, in order; the first and the last are no sounds. They are the track's. */
struct viseme_key;
const struct viseme_key *face_track_visemes(const struct face_track *track, size_t *count);

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
