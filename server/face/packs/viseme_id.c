/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/packs/viseme_id.h"
#include <string.h>

/* By the visemes of FAP 1, whose examples are p f th t k sh s n r and the vowels a e i o u. */
static const uint8_t of_viseme[] = {0, 21, 18, 17, 19, 20, 16, 15, 19, 13, 2, 4, 6, 8, 7};

uint8_t viseme_id_of(const struct speech_phone *phone) {
    if (!phone)
        return 0;
    for (const struct viseme_id *row = viseme_ids; row->ipa; row++)
        if (!strcmp(row->ipa, phone->ipa))
            return row->id;
    return of_viseme[phone->viseme];
}
