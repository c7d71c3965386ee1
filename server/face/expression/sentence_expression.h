/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a sentence expresses: its cues, and how much of the mouth speech needs. Immutable. */
#ifndef FACCIA_FACE_EXPRESSION_SENTENCE_EXPRESSION_H
#define FACCIA_FACE_EXPRESSION_SENTENCE_EXPRESSION_H

#include "server/face/engines/phone_segments.h"
#include "server/face/expression/cue_envelope.h"

/* An expression of the mouth comes and goes within this time, s; in pauses under twice that it stays away. */
#define ACTIVITY_RAMP 0.2

/* How much of the mouth speech needs: 1 while she speaks, 0 in pauses and outside of the sentence. */
struct activity {
    struct activity_run {
        double rise, begin, end, fall; /* s: 0 at rise, 1 from begin to end, 0 at fall */
    } * runs;
    size_t count, cap;
};

struct sentence_expression {
    const struct expressions *expressions; /* a share; NULL: there are none to show cues with */
    enum face_blend rule;
    struct cue_envelopes envelopes;
    struct activity activity;
};

void sentence_expression_from(const struct sentence_audio *u, const struct phone_segments *g,
                              const struct face_options *options, struct sentence_expression *out);
void sentence_expression_free(struct sentence_expression *expression);

/* 0..1, continuous in value and slope. *cursor begins as 0 and is kept between calls. */
double activity_at(const struct activity *activity, double t, size_t *cursor);

#endif
