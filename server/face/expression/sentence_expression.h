/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a sentence expresses: its cues, and how much of the mouth speech needs. Immutable. */
#ifndef FACCIA_FACE_EXPRESSION_SENTENCE_EXPRESSION_H
#define FACCIA_FACE_EXPRESSION_SENTENCE_EXPRESSION_H

#include "server/face/expression/activity.h"
#include "server/face/expression/cue_envelope.h"

struct sentence_expression {
    bool expresses; /* false: there are no expressions to show cues with */
    enum face_blend rule;
    struct cue_envelopes envelopes;
    struct activity activity;
};

void sentence_expression_from(const struct sentence_audio *u, const struct phone_segments *g,
                              const struct face_options *options, struct sentence_expression *out);
void sentence_expression_free(struct sentence_expression *expression);

#endif
