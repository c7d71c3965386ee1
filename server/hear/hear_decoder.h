/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From how likely each class is, frame by frame, to sounds with their times. A closure that is missed is
 * worse than one too many: it begins as soon as it is likely, and holds until it is not. */
#ifndef FACCIA_HEAR_HEAR_DECODER_H
#define FACCIA_HEAR_HEAR_DECODER_H

#include "server/hear/hear_classes.h"
#include <stdbool.h>
#include <stdint.h>

/* Frame k is the 10 ms around the middle of the window that it was made of, which begin k frames after this.
 */
#define HEAR_FIRST_SECONDS 0.0075
enum { HEAR_FRAMES_A_SECOND = 100 };

struct hear_phone {
    enum hear_class class;
    uint32_t start, end;         /* it ends where the next begins */
    double likely[HEAR_CLASSES]; /* sums over its frames of how likely each class was */
};

struct hear_decoder {
    struct hear_phone now; /* end = what has been heard so far */
    enum hear_class next;  /* may be about to begin */
    uint32_t since;        /* from that frame on; nothing is when this is now.end */
    double next_likely[HEAR_CLASSES], before[HEAR_CLASSES]; /* over its frames; over now's before it */
};

void hear_decoder_begin(struct hear_decoder *decoder);

/* Takes the next frame. True: a phone has ended, which is in *ended. */
bool hear_decoder_step(struct hear_decoder *decoder, const float likely[HEAR_CLASSES],
                       struct hear_phone *ended);

#endif
