/* SPDX-License-Identifier: MIT */
/* Predicts FAPC values and codes the prediction errors. Private to the FAPC coder. */
#ifndef FACCIA_PROTOCOL_FAPC_MODEL_H
#define FACCIA_PROTOCOL_FAPC_MODEL_H

#include "protocol/fapc/fapc.h"

/* Prior of a FAP, from fapc-prior.json. */
struct fapc_habit {
    uint8_t group, eighths;                             /* of the MPEG-4 quantiser step, for a quality of 1 */
    uint8_t models[2];                                  /* FAPs before it that it moves like; 0 = none */
    int16_t weights[FAPC_WEIGHTS], exact[FAPC_WEIGHTS]; /* of what is known, in 1/4096; exact: without loss */
};

/* Indexed by FAP number, 3..FAP_COUNT. */
extern const struct fapc_habit fapc_habits[FAP_COUNT + 1];

/* Probabilities of a 0 to begin with, of 65536. */
extern const uint16_t fapc_prior_zero[FAPC_GROUPS][FAPC_ZEROS], fapc_prior_sign[FAPC_GROUPS][FAPC_SIGNS],
    fapc_prior_size[FAPC_GROUPS][FAPC_CLASSES * FAPC_UNARY];

/* Forgets all but the number of the next packet. */
void fapc_reset(struct fapc_state *s, int quality);

void fapc_next_frame(struct fapc_state *s);
void fapc_put_value(struct fapc_state *s, struct range_encoder *e, int n, int32_t value);

/* False when it cannot be: the bytes are damaged. */
bool fapc_get_value(struct fapc_state *s, struct range_decoder *d, int n);

#endif
