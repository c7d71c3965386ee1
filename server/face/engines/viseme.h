/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FAP 1 for simple decoders: two of the 14 static visemes and their blend (ISO/IEC 14496-2, annex C). */
#ifndef FACCIA_FACE_ENGINES_VISEME_H
#define FACCIA_FACE_ENGINES_VISEME_H

#include "protocol/fap.h"
#include "server/face/engines/phone_segments.h"

struct viseme_key {
    double begin,
        end; /* s: shown alone from begin to end; blended with the next one from there to that one's begin */
    uint8_t viseme;             /* 0 none, 1..14 */
    uint8_t id;                 /* viseme_id.h */
    double from, to;            /* s, of the sound itself; the same when there is none */
    char ipa[PHONE_NAME_BYTES]; /* its name in the pack; "" = a pause */
};

struct visemes {
    struct viseme_key *keys;
    size_t count;
};

void visemes_from(const struct phone_segments *g, struct visemes *out);
void visemes_free(struct visemes *visemes);

/* *cursor begins as 0 and is kept between calls. */
struct fap_viseme visemes_at(const struct visemes *visemes, double t, size_t *cursor);

#endif
