/* SPDX-License-Identifier: MIT */
/* How FBA guesses a value and codes what it did not guess. Inside of fba.c. */
#ifndef FACCIA_PROTOCOL_FBA_MODEL_H
#define FACCIA_PROTOCOL_FBA_MODEL_H

#include "protocol/rangecoder.h"

/* What fba-prior.json says of a FAP. */
struct fba_habit {
    uint8_t group, eighths;                           /* of the MPEG-4 quantiser step, for a quality of 1 */
    uint8_t models[2];                                /* FAPs before it that it moves like; 0 = none */
    int16_t weights[FBA_WEIGHTS], exact[FBA_WEIGHTS]; /* of what is known, in 1/4096; exact: without loss */
};

/* Indexed by FAP number, 3..FAP_COUNT. */
extern const struct fba_habit fba_habits[FAP_COUNT + 1];

/* Probabilities of a 0 to begin with, of 65536. */
extern const uint16_t fba_prior_zero[FBA_GROUPS][FBA_ZEROS], fba_prior_sign[FBA_GROUPS][FBA_SIGNS],
    fba_prior_size[FBA_GROUPS][FBA_CLASSES * FBA_UNARY];

/* Forgets all but the number of the next packet. */
void fba_reset(struct fba_state *s, int quality);

void fba_next_frame(struct fba_state *s);
void fba_put_value(struct fba_state *s, struct range_encoder *e, int n, int32_t value);

/* False when it cannot be: the bytes are damaged. */
bool fba_get_value(struct fba_state *s, struct range_decoder *d, int n);

#endif
