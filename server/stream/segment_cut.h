/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cutting a segment into media chunks, and finding the words, marks and place that begin in each. */
#ifndef FACCIA_STREAM_SEGMENT_CUT_H
#define FACCIA_STREAM_SEGMENT_CUT_H

#include "protocol/chunk.h"
#include "server/synthesis/synthesis.h"

/* Where one has come in a segment. Begins zeroed. */
struct segment_cut {
    uint32_t at; /* sample of the segment */
    size_t word, mark, phone;
};

/* The chunk from cut->at on, at most samples long, with its frames in frames (room for CUT_FRAMES). Moves
 * cut->at on. The words and marks from cut->word and cut->mark on that begin before the new cut->at belong to
 * it. */
enum { CUT_FRAMES = 32 };
void segment_cut_chunk(struct segment_cut *cut, const struct media_segment *segment, double fps,
                       uint32_t samples, struct chunk *chunk, struct fap_frame *frames);

/* Enters the segment where it is to be heard from. */
void segment_cut_enter(struct segment_cut *cut, const struct media_segment *segment);

#endif
