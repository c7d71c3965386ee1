/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a synthesis or a recording hands on: sound and face of a stretch of it. */
#ifndef FACCIA_SYNTHESIS_MEDIA_SEGMENT_H
#define FACCIA_SYNTHESIS_MEDIA_SEGMENT_H

#include "server/face/track.h"

/* One spoken sentence, or a piece of a recording. Its audio and its track are shared and do not change; the
 * receiver of a segment owns its part of them. */
struct media_segment {
    struct sentence_audio *audio;
    struct face_track *track; /* NULL: the face is in frames */
    int64_t start; /* its first sample, counted from the speech's beginning; below 0 when `skip` hides that */
    uint32_t skip; /* samples at its beginning that are not to be heard */
    size_t sentence;                /* which one it is, from 0 */
    bool wait;                      /* it is none: silence, while more text is awaited */
    struct placement_options alone; /* how its face is placed when nothing is played but this speech */
    const struct fap_frame *frames; /* of the whole recording, borrowed; the last one stays */
    size_t frame_count;
    uint32_t first_frame;  /* the number of the first of them, of a voice that is heard */
    struct fap_frame *own; /* the same, where they are the segment's own; else NULL */
    bool mouth;            /* they are the mouth's: the rest of the face lives */
};

void media_segment_free(struct media_segment *segment);

/* A placement of its track, or of what lives beside the mouth, for media_segment_frame; NULL when it has
 * neither. */
struct face_placement *media_segment_place(const struct media_segment *segment,
                                           const struct placement_options *options);

/* The frame with number k of the speech, k / fps seconds from its beginning. */
void media_segment_frame(const struct media_segment *segment, struct face_placement *placement, double fps,
                         uint32_t k, struct fap_frame *frame);

/* The first frame that does not lie before that sample of the speech. */
uint32_t frame_from_sample(uint64_t sample, uint32_t sample_rate, double fps);

#endif
