/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output of a synthesis, a recording or a live voice: sound and face for a stretch of time. */
#ifndef FACCIA_SYNTHESIS_MEDIA_SEGMENT_H
#define FACCIA_SYNTHESIS_MEDIA_SEGMENT_H

#include "server/face/track.h"

/* A spoken sentence, or a piece of a recording. Audio and track are shared and immutable; the receiver
 * owns a reference to each. */
struct media_segment {
    struct sentence_audio *audio;
    struct face_track *track; /* NULL = use frames */
    int64_t start;   /* first sample from the start of the utterance; negative when hidden by `skip` */
    uint32_t skip;   /* samples at the beginning that are not played */
    size_t sentence; /* index from 0 */
    bool wait;       /* silence while more text is awaited */
    struct placement_options alone; /* placement of the face when played on its own */
    const struct fap_frame *frames; /* of the whole recording, borrowed; the last one is repeated */
    size_t frame_count;
    uint32_t first_frame;  /* number of the first frame, for a live voice */
    struct fap_frame *own; /* the same if owned by the segment, else NULL */
    bool mouth;            /* frames contain only the mouth; life is added */
};

void media_segment_free(struct media_segment *segment);

/* Places the segment's track, or the life beside a recognised mouth, for media_segment_frame. Returns NULL
 * if it has neither. */
struct face_placement *media_segment_place(const struct media_segment *segment,
                                           const struct placement_options *options);

/* Computes frame k of the utterance, k / fps seconds from its beginning. */
void media_segment_frame(const struct media_segment *segment, struct face_placement *placement, double fps,
                         uint32_t k, struct fap_frame *frame);

/* Returns the first frame at or after the sample. */
uint32_t frame_from_sample(uint64_t sample, uint32_t sample_rate, double fps);

#endif
