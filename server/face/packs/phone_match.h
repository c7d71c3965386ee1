/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From what a voice calls a phone to the phones of a pack. */
#ifndef FACCIA_FACE_PACKS_PHONE_MATCH_H
#define FACCIA_FACE_PACKS_PHONE_MATCH_H

#include "server/face/packs/speech_pack_content.h"

enum { PHONE_MATCHES_MAX = 64 };

struct phone_match {
    const struct speech_phone *phone; /* never one that is made of parts */
    double share;                     /* of the time; all shares add up to 1 */
};

struct phone_matches {
    struct phone_match match[PHONE_MATCHES_MAX];
    size_t count; /* 0: nothing to be seen, such as a mark alone */
    /* The first letter that the pack lacks, with its nearest phone (NULL when the alphabet lacks it too).
     * code 0: none. */
    uint32_t unknown;
    const struct speech_phone *stand_in;
};

/* Cuts the IPA name of a phone (a diphthong, an affricate with or without tie, with or without diacritics; or
 * SAMPA, where no IPA key fits) into the longest keys of the pack. Diacritics that no key contains are
 * skipped. */
void phone_match_find(const struct speech_pack *pack, const char *ipa, struct phone_matches *out);

#endif
