/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps phone names of voices to phones of a pack. */
#ifndef FACCIA_FACE_PACKS_PHONE_MATCH_H
#define FACCIA_FACE_PACKS_PHONE_MATCH_H

#include "server/base/error.h"
#include "server/face/packs/speech_pack_content.h"
#include "server/voice/sentence_audio.h"

enum { PHONE_MATCHES_MAX = 64 };

struct phone_match {
    const struct speech_phone *phone; /* never one made of parts */
    double share;                     /* of the time; shares add up to 1 */
};

struct phone_matches {
    struct phone_match match[PHONE_MATCHES_MAX];
    size_t count; /* 0: not visible, such as a lone diacritic */
    /* The first letter missing in the pack, with its nearest phone (NULL when the alphabet lacks it too).
     * code 0 = none. */
    uint32_t unknown;
    const struct speech_phone *stand_in;
};

/* Splits a phone's IPA name (a diphthong, an affricate with or without tie or diacritics; or SAMPA, if no
 * IPA key matches) into the longest keys of the pack. Unknown diacritics are skipped. */
void phone_match_find(const struct speech_pack *pack, const char *ipa, struct phone_matches *out);

#endif
