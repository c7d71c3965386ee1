/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cutting a scene into media chunks, and finding the words, marks and place that begin in each. */
#ifndef FACCIA_STREAM_CUT_H
#define FACCIA_STREAM_CUT_H

#include "protocol/chunk.h"
#include "server/stream/speech.h"

/* Where one has come in a scene. Begins zeroed. */
struct cut {
    uint32_t at; /* sample of the scene */
    size_t word, mark, phone;
};

/* The chunk from cut->at on, at most samples long, with its frames in frames (room for CUT_FRAMES). Moves
 * cut->at on. The words and marks from cut->word and cut->mark on that begin before the new cut->at belong to
 * it. */
enum { CUT_FRAMES = 32 };
void cut_chunk(struct cut *cut, const struct scene *scene, double fps, uint32_t samples, struct chunk *chunk,
               struct fap_frame *frames);

/* Enters the scene where it is to be heard from. */
void cut_enter(struct cut *cut, const struct scene *scene);

#endif
