/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A placement: a face track as it is played once, on a life clock, with a life and a mood
 * of its own; or the face while nobody speaks. What is played again, later or by another is placed anew, and
 * nothing is made twice but this. */
#ifndef FACCIA_FACE_PLACEMENT_H
#define FACCIA_FACE_PLACEMENT_H

#include "server/face/face_layer.h"
#include "server/face/track.h"

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

#endif
