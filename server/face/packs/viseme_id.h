/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The 22 viseme ids that speech services count: models/shapes/viseme-ids.json, made into a table while
 * building. */
#ifndef FACCIA_FACE_PACKS_VISEME_ID_H
#define FACCIA_FACE_PACKS_VISEME_ID_H

#include "server/face/packs/speech_pack_content.h"

enum { VISEME_IDS = 22 };

struct viseme_id {
    const char *ipa;
    uint8_t id;
};

/* Ended by an ipa of NULL. */
extern const struct viseme_id viseme_ids[];

/* Of a phone of a pack, NULL = a pause: 0..21. One that the table does not name has that of its FAP 1. */
uint8_t viseme_id_of(const struct speech_phone *phone);

#endif
