/* SPDX-License-Identifier: MIT */
/* Binary arithmetic coding with a 32-bit range (G. N. N. Martin, "Range encoding", 1979), one bit at a time,
 * each with its own adaptive probability. */
#ifndef FACCIA_PROTOCOL_RANGECODER_H
#define FACCIA_PROTOCOL_RANGECODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A probability that adapts to the bits that are coded with it. */
struct range_context {
    uint16_t zero; /* probability of a 0, of 65536 */
    uint8_t seen;
};

struct range_encoder {
    uint64_t low;
    uint32_t range;
    uint8_t *out;
    size_t size, cap; /* bytes beyond cap are counted, not written */
};

struct range_decoder {
    uint32_t range, code;
    const uint8_t *at, *end;
    size_t beyond; /* bytes asked for beyond the end; they are 0 */
};

void range_encoder_init(struct range_encoder *e, uint8_t *out, size_t cap);
void range_put(struct range_encoder *e, struct range_context *context, int bit);

/* Without a context: both values are as likely. */
void range_put_even(struct range_encoder *e, int bit);

/* Ends the code with as few bytes as it takes; zeros at the end are left out. Returns its size. */
size_t range_finish(struct range_encoder *e);

void range_decoder_init(struct range_decoder *d, const uint8_t *data, size_t size);
int range_get(struct range_decoder *d, struct range_context *context);
int range_get_even(struct range_decoder *d);

/* Bytes are left that no encoder would have written. */
bool range_early(const struct range_decoder *d);

#endif
