/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FAP 1 and 2, the high-level FAPs, as movements: what a recording that says "viseme 1" or "joy" shows on a
 * head that is moved by FAPs from 3 on. Tables 2 and 3 of ISO/IEC 14496-2, Annex C, name the visemes by
 * examples and the expressions in words; how they look is the language packs' and the expressions file's. */
#ifndef FACCIA_FACE_HIGH_LEVEL_H
#define FACCIA_FACE_HIGH_LEVEL_H

#include "protocol/fap.h"
#include "server/expression/expressions.h"
#include "server/face/packs/speech_pack_content.h"

struct face_high_level;

/* From the general pack's phones (NULL = visemes move nothing) and the basic emotions' poses. Both may be
 * freed afterwards. */
struct face_high_level *face_high_level_new(const struct speech_pack *pack,
                                            const struct expressions *expressions);
void face_high_level_free(struct face_high_level *high);

/* Adds to the frames what their FAP 1 and 2 mean, in those FAPs that no frame moves: a recording knows best
 * what it says itself. FAP 1: viseme 1 * blend / 63 + viseme 2 * (63 - blend) / 63; FAP 2: both expressions
 * at their intensities / 63. high = NULL does nothing. */
void face_high_level_expand(const struct face_high_level *high, struct fap_frame *frames, size_t count);

#endif
