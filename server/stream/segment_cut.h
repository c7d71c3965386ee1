/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cutting a segment into pieces, and finding the words, marks and place that begin in each. */
#ifndef FACCIA_STREAM_SEGMENT_CUT_H
#define FACCIA_STREAM_SEGMENT_CUT_H

#include "server/stream/media.h"
#include "server/synthesis/media_segment.h"

/* Where one has come in a segment. Begins zeroed. */
struct segment_cut {
    uint32_t at; /* sample of the segment */
    size_t word, mark, phone;
};

/* The media from cut->at on, at most samples long, with frames of that placement in media->frames (room for
 * CUT_FRAMES). Moves cut->at on. The words and marks from cut->word and cut->mark on that begin before the
 * new cut->at belong to it. */
enum { CUT_FRAMES = 32 };
void segment_cut_media(struct segment_cut *cut, const struct media_segment *segment,
                       struct face_placement *face, double fps, uint32_t samples, struct media *media);

/* Enters the segment where it is to be heard from. */
void segment_cut_enter(struct segment_cut *cut, const struct media_segment *segment);

#endif
