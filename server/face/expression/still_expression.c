/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/expression/still_expression.h"
#include "server/face/expression/blend.h"
#include "server/face/face_limits.h"
#include <math.h>

/* How far a pose is from rest, each FAP against its range. */
static double size(const struct pose *pose) {
    double sum = 0;
    for (size_t i = 0; i < pose->count; i++)
        sum += fabs(pose->faps[i].value) / fap_table[pose->faps[i].fap].max;
    return sum;
}

void still_expression(const struct expressions *expressions, size_t index, double intensity,
                      struct fap_frame *frame) {
    const struct expression *x = expressions_at(expressions, index);
    double faps[FAP_COUNT + 1] = {0}, shares[BASIC_COUNT + 1];
    struct blend blend = {.face = faps};
    const struct pose *strongest = NULL;
    for (size_t i = 0; i < x->key_count; i++)
        if (!strongest || size(&x->keys[i].pose) > size(strongest))
            strongest = &x->keys[i].pose;
    blend_add(&blend, &x->pose, intensity, x->mouth);
    if (strongest)
        blend_add(&blend, strongest, intensity, x->mouth);
    blend_join(&blend);
    for (int b = 1; b <= BASIC_COUNT; b++)
        shares[b] = x->basics[b] * intensity;
    *frame = (struct fap_frame){.expression = blend_basics(shares)};
    frame->mask[0] |= 2; /* FAP 2 */
    face_limits_apply(face_idle_fapu, faps, frame);
}
