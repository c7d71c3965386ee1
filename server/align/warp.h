/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dynamic time warping (H. Sakoe and S. Chiba, IEEE Trans. ASSP 26, 1978) of a recording onto a reference of
 * the same words: which moment of the recording is which of the reference. Between words the recording may
 * pause where the reference does not, and run on where the reference pauses. */
#ifndef FACCIA_ALIGN_WARP_H
#define FACCIA_ALIGN_WARP_H

#include "server/align/mfcc.h"
#include <stdatomic.h>

struct warp_options {
    /* Frames of the reference before which the recording may pause: the words' beginnings, in order. */
    const size_t *gaps;
    size_t gap_count;
    const atomic_bool *stop; /* NULL, or true when nobody wants the result any more */
    bool open_end;           /* the recording may go on after the reference's last frame */
};

/* How far two frames are from each other. */
float warp_distance(const float *x, const float *y);

/* For each frame j of the reference the frames of the recording from at[j] to until[j], exclusive; what lies
 * between until[j] and at[j + 1] is a pause that the reference does not have. at[reference->count] is the
 * end. Neither decreases. Returns the mean distance along the path, or a negative number when the recording
 * is too short to hold the reference (fewer than a third of its frames), or it was stopped. Memory: about
 * recording->count * (reference->count + gap_count) bytes. */
double warp(const struct features *recording, const struct features *reference,
            const struct warp_options *options, size_t *at, size_t *until);

#endif
