/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the face of a stream is cut (a barge-in, a jump, a pause), what comes next begins elsewhere. Head,
 * eyes and brows go over to it from where they are. The mouth of speech does not: it has to be right at once.
 */
#ifndef FACCIA_STREAM_FACE_EASE_H
#define FACCIA_STREAM_FACE_EASE_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define EASE_UPPER 0.35 /* s */
#define EASE_MOUTH 0.12 /* s, when nobody speaks */

enum {
    EASE_SOON_MS = 2000, /* what comes later than so long after a cut begins where it begins */
};

/* Begins zeroed. */
struct face_ease {
    bool shown;            /* there is a last frame */
    struct fap_frame last; /* that was given out */
    bool active;
    struct fap_frame from;
    double age;       /* s since the cut, of the media's time */
    uint64_t until;   /* loop time up to which the cut counts, ms; 0: there was none */
    bool from_is_set; /* else it is from the last frame */
};

/* The frames from now on do not follow from those before; from = NULL: from the last one. */
void face_ease_cut(struct face_ease *ease, const struct fap_frame *from, uint64_t now);

enum ease_what {
    EASE_NOTHING, /* what must be as it is: recordings, utterances that are to be repeated exactly */
    EASE_FACE,    /* all but the mouth */
    EASE_ALL,
};

/* Eases frames that are given out, and remembers the last. */
void face_ease_frames(struct face_ease *ease, enum ease_what what, uint64_t now, double fps,
                      struct fap_frame *frames, size_t count);

/* Changes frames so that they go over to `to`: they are the part from..end (0..1) of the way, at whose end
 * they are there. */
void face_ease_towards(const struct fap_frame *to, struct fap_frame *frames, double from, double end,
                       size_t count);

#endif
