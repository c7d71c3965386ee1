/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a vowel has to open at least, as contacts are what consonants have to close: whatever the engine, the
 * rate, an expression or a blend made of the lips, a vowel that does not open is taken for a closed one. Part
 * of the layer of contacts (face_options.contacts). */
#ifndef FACCIA_FACE_ENGINES_OPENING_H
#define FACCIA_FACE_ENGINES_OPENING_H

#include "protocol/fap.h"
#include "server/face/engines/contact.h"

/* Of a vowel's own opening (LI + LS before a pause, by its stress): what is left of it in the shortest vowel,
 * and in one that lasts OPENING_LONG seconds or more. */
#define OPENING_SHORT 0.5
#define OPENING_FULL 0.7
#define OPENING_LONG 0.16

struct opening {
    double begin, end;        /* open by gap from begin to end, s */
    double ramp_in, ramp_out; /* how long before and after it is felt, s */
    double gap;               /* mm between the inner lips in the middle */
};

struct openings {
    struct opening *items; /* in order of time */
    size_t count, cap;
};

/* Openings end where contacts begin. */
void openings_from(const struct phone_segments *g, const struct contacts *contacts, struct openings *out);
void openings_free(struct openings *openings);

/* Opens the lips of the face at t as far as is demanded then. *cursor begins as 0 and is kept between calls.
 */
void openings_show(const struct openings *openings, double t, size_t *cursor, const struct speech_fapu *fapu,
                   double faps[FAP_COUNT + 1]);

#endif
