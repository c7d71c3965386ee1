/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of the mouth speech needs: 1 while she speaks, 0 in pauses and outside of the sentence. */
#ifndef FACCIA_FACE_EXPRESSION_ACTIVITY_H
#define FACCIA_FACE_EXPRESSION_ACTIVITY_H

#include "server/face/engines/phone_segments.h"

/* An expression of the mouth comes and goes within this time, s; in pauses under twice that it stays away. */
#define ACTIVITY_RAMP 0.2

struct activity {
    struct activity_run {
        double rise, begin, end, fall; /* s: 0 at rise, 1 from begin to end, 0 at fall */
    } * runs;
    size_t count, cap;
};

void activity_from(const struct phone_segments *g, struct activity *out);
void activity_free(struct activity *activity);

/* 0..1, continuous in value and slope. *cursor begins as 0 and is kept between calls. */
double activity_at(const struct activity *activity, double t, size_t *cursor);

#endif
