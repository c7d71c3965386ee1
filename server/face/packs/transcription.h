/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From what a voice calls a phone to the phones of a pack. */
#ifndef FACCIA_FACE_TRANSCRIPTION_H
#define FACCIA_FACE_TRANSCRIPTION_H

#include "server/base/error.h"
#include "server/face/packs/speech_pack_content.h"
#include "server/voice/sentence_audio.h"

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

/* Timed phonetic transcriptions of recorded speech (P. D. P. Costa, UNICAMP 2009, 5.1): one line for each
 * phone, "INDEX: OFFSET SYMBOL", the offset being the phone's first byte in the sound file; a last line
 * without a symbol tells where the sentence ends. ## is silence, a quote before a vowel's symbol marks the
 * stress. */

/* The sound file that offsets count in. */
struct transcription_sound {
    size_t header; /* bytes before the first sample */
    uint32_t rate; /* Hz */
    size_t frame;  /* bytes of one sample of all channels */
};

/* 16 kHz, 16 bit, mono, after a WAV header, as the thesis has it. */
extern const struct transcription_sound transcription_wav;

/* A sentence without sound, whose symbols are those of the pack's table of visemes. NULL with *e (code
 * "bad-transcription" and the line; "unknown-engine" when the pack has no such table). Release it with
 * sentence_audio_free. */
struct sentence_audio *transcription_read(const char *text, size_t size,
                                          const struct transcription_sound *sound,
                                          const struct speech_pack *pack, struct error *e);

#endif
