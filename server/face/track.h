/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The face track: what follows from a sentence alone, over the time from its own zero: the mouth, what lips
 * must touch, the cues' expressions, FAP 1. Immutable, so that it can be kept, shared and played again;
 * placement.h plays it. */
#ifndef FACCIA_FACE_TRACK_H
#define FACCIA_FACE_TRACK_H

#include "protocol/fap.h"
#include "server/face/face_options.h"
#include "server/face/packs/speech_pack.h"
#include "server/face/packs/speech_param.h"
#include "server/voice/sentence_audio.h"

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
