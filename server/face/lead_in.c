/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/lead_in.h"
#include "server/face/packs/phone_match.h"

static const struct phone *first_sound(const struct sentence_audio *u) {
    for (size_t i = 0; i < u->phone_count; i++)
        if (*u->phones[i].ipa)
            return &u->phones[i];
    return NULL;
}

uint32_t lead_in_missing(const struct speech_pack *pack, const struct sentence_audio *u) {
    const struct phone *first = first_sound(u);
    uint32_t needed = (uint32_t)(LEAD_IN_SECONDS * u->sample_rate);
    struct phone_matches found;
    if (!first || first->start >= needed)
        return 0;
    phone_match_find(pack, first->ipa, &found);
    return found.count && found.match[0].phone->contact.kind ? needed - first->start : 0;
}
