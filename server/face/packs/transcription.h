/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Timed phonetic transcriptions of recordings (P. D. P. Costa, UNICAMP 2009, 5.1): one line per phone,
 * "INDEX: OFFSET SYMBOL", where OFFSET is the phone's first byte in the sound file; a last line without a
 * symbol ends the sentence. ## is silence, a quote before a vowel's symbol marks stress. */
#ifndef FACCIA_FACE_TRANSCRIPTION_H
#define FACCIA_FACE_TRANSCRIPTION_H

#include "server/base/error.h"
#include "server/face/packs/speech_pack_content.h"
#include "server/voice/sentence_audio.h"

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
