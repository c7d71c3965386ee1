/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FAP 1 and 2, the high-level FAPs. */
#ifndef FACCIA_FACE_HIGH_LEVEL_H
#define FACCIA_FACE_HIGH_LEVEL_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/face/engines/phone_segments.h"
#include "server/face/packs/speech_pack.h"

/* FAP 1 for simple decoders: two of the 14 static visemes and their blend (ISO/IEC 14496-2, annex C). */

struct viseme_key {
    double begin, end; /* s: shown alone from begin to end, then blended into the next key until its begin */
    uint8_t viseme;    /* 0 none, 1..14 */
    uint8_t id;        /* shape_table.h */
    double from, to;   /* s, of the sound itself; equal if there is none */
    char ipa[PHONE_NAME_BYTES]; /* name in the pack; "" = a pause */
};

struct visemes {
    struct viseme_key *keys;
    size_t count;
};

void visemes_from(const struct phone_segments *g, struct visemes *out);
void visemes_free(struct visemes *visemes);

/* cursor is zero-initialised and kept between calls. */
struct fap_viseme visemes_at(const struct visemes *visemes, double t, size_t *cursor);

/* Expands FAP 1 and 2, the high-level FAPs, so that a recording with only "viseme 1" or "joy" moves a head
 * driven by FAPs from 3 on. Tables 2 and 3 of ISO/IEC 14496-2, Annex C, name visemes by examples and
 * expressions in words; their appearance comes from the language packs and the expressions file. */

struct face_high_level;

/* Built from the general pack's phones (NULL = ignore visemes) and the basic emotions' poses, which may be
 * freed afterwards. */
struct face_high_level *face_high_level_new(const struct speech_pack *pack,
                                            const struct expressions *expressions);
void face_high_level_free(struct face_high_level *high);

/* Adds the effect of FAP 1 and 2 to the frames, in FAPs that no frame sets. FAP 1: viseme 1 * blend / 63 +
 * viseme 2 * (63 - blend) / 63; FAP 2: both expressions at their intensities / 63. Does nothing if high is
 * NULL. */
void face_high_level_expand(const struct face_high_level *high, struct fap_frame *frames, size_t count);

#endif
