/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/expression/sentence_expression.h"

void sentence_expression_from(const struct sentence_audio *u, const struct phone_segments *g,
                              const struct face_options *options, struct sentence_expression *out) {
    *out = (struct sentence_expression){.expresses = options->expressions, .rule = options->blend};
    if (options->expressions)
        cue_envelopes_from(u, options->expressions, options->blend, &out->envelopes);
    activity_from(g, &out->activity);
}

void sentence_expression_free(struct sentence_expression *expression) {
    cue_envelopes_free(&expression->envelopes);
    activity_free(&expression->activity);
}
