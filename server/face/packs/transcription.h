/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps phone names of voices to phones of a pack, and reads timed transcriptions. */
#ifndef FACCIA_FACE_TRANSCRIPTION_H
#define FACCIA_FACE_TRANSCRIPTION_H

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

/* Timed phonetic transcriptions of recordings (P. D. P. Costa, UNICAMP 2009, 5.1): one line per phone,
 * "INDEX: OFFSET SYMBOL", where OFFSET is the phone's first byte in the sound file; a last line without a
 * symbol ends the sentence. ## is silence, a quote before a vowel's symbol marks stress. */

/* The sound file that offsets refer to. */
struct transcription_sound {
    size_t header; /* bytes before the first sample */
    uint32_t rate; /* Hz */
    size_t frame;  /* bytes of one sample of all channels */
};

/* 16 kHz, 16 bit, mono, after a WAV header, as in the thesis. */
extern const struct transcription_sound transcription_wav;

/* Returns a sentence without sound; symbols are those of the pack's viseme table. Returns NULL with *e
 * ("bad-transcription" with the line; "unknown-engine" without such a table). Free it with
 * sentence_audio_free. */
struct sentence_audio *transcription_read(const char *text, size_t size,
                                          const struct transcription_sound *sound,
                                          const struct speech_pack *pack, struct error *e);

#endif
