/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes curves of the articulatory parameters from segments: targets in context (Leone, "LUCIA-WebGL",
 * 3.17-3.19). */
#ifndef FACCIA_FACE_ENGINES_TARGETS_H
#define FACCIA_FACE_ENGINES_TARGETS_H

#include "server/face/engines/dominance.h"
#include "server/face/engines/phone_segments.h"

/* The curve's function: LUCIA's, or its origin (3.2). The others are ablations of LUCIA's: without the
 * shape (S = 1); or without the resistance (R = 1), and so without the shape, which is scaled by the
 * resistance's reach. */
enum targets_function { TARGETS_LOOK_AHEAD, TARGETS_ORIGINAL, TARGETS_NO_SHAPE, TARGETS_NO_RESISTANCE };

/* Computes all curves by these rules:
 * - A consonant between two vowels gets the mean of its coefficients in the two symmetric contexts (3.17,
 *   3.18); every consonant of a cluster uses the vowels around the cluster. Beside a pause only one vowel
 *   counts.
 * - A vowel gets the coefficients for the consonant that follows it, interpolated between its unstressed and
 *   stressed form.
 * - Target instants follow (3.19).
 * - Undershoot: a vowel covers the fraction 1 - exp(-(d / u)^1.5) of the way from its consonants' targets to
 *   its own, where u is the pack's "undershoot" (after Lindblom, JASA 35, 1963: vowels shrink with their
 *   duration). For lips and jaw d is the mean time to the nearest targets on both sides that hold (alpha k of
 *   at least 0.5), because the mouth keeps opening through glides: people open a 60 ms /ae/ of "planks" by
 *   18 mm. For the tongue d is the vowel's length. Without undershoot a vowel that resists like a consonant
 *   would open fully at any speech rate. The original function, in which nothing confines a segment,
 *   undershoots by itself and gets the plain targets.
 * - A pause returns the mouth to rest, completely if it is long enough. The mouth is at rest at time 0 and at
 *   the end. */
void targets_curves(const struct speech_pack *pack, const struct phone_segments *g,
                    enum targets_function function, struct curve curves[PARAM_COUNT]);

/* The same for one parameter alone. */
void targets_curve(const struct speech_pack *pack, const struct phone_segments *g,
                   enum targets_function function, int param, struct curve *curve);

/* The contexts of each segment, as indices into a phone's tables: for a consonant those of its two vowels,
 * for a vowel twice that of what follows. The caller frees them. */
struct target_contexts {
    size_t before, after;
};
struct target_contexts *targets_contexts(const struct phone_segments *g);

#endif
