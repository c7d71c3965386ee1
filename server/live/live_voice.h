/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A live voice: sound from a client, shown with mouth movements recognised from it. */
#ifndef FACCIA_LIVE_LIVE_VOICE_H
#define FACCIA_LIVE_LIVE_VOICE_H

#include "server/synthesis/speech_request.h"
#include "server/synthesis/speech_source.h"

/* A request: the format of the sound and how it is shown. */

enum {
    LIVE_RATE_MIN = 8000,
    LIVE_RATE_MAX = 96000,
    LIVE_CHANNELS_MAX = 8,
    LIVE_LOOKAHEAD = 80, /* default, ms */
};

enum live_codec { LIVE_PCM, LIVE_OPUS };

/* "pcm_s16le" and "opus", in the order of the enum, NULL-terminated. */
extern const char *const live_codecs[];

struct live_request {
    const struct speech_request *speech; /* its fields other than those of a text */
    enum live_codec codec;
    unsigned rate, channels, lookahead; /* Hz; ms */
    const char *room;                   /* for a recogniser; NULL: none */
};

/* Returns -1 with *e ("unknown-codec", field "codec"). Accepts "pcm" too. */
int live_codec_find(const char *name, enum live_codec *codec, struct error *e);

/* Checks the sound format. Returns -1 with *e ("bad-field"). */
int live_request_check(const struct live_request *request, struct error *e);

/* Decodes a client's messages to mono samples. */

struct live_audio;

/* Returns NULL with the errors of live_request_check. */
struct live_audio *live_audio_new(const struct live_request *request, struct error *e);
void live_audio_free(struct live_audio *sound);

/* Decodes a message: interleaved signed 16-bit little-endian samples, cut anywhere; or one Opus packet.
 * Passes at most LIVE_BLOCK samples at a time to `give`. Returns -1 with *e ("bad-sound", at the byte of
 * the whole stream) for an invalid packet, which is concealed. */
enum { LIVE_BLOCK = 8192 };
int live_audio_read(struct live_audio *sound, const uint8_t *bytes, size_t size,
                    void (*give)(void *ctx, const int16_t *samples, size_t count), void *ctx,
                    struct error *e);

/* Returns -1 with *e when the last sample is incomplete. */
int live_audio_end(const struct live_audio *sound, struct error *e);

/* Turns a live voice into segments like those of a synthesis: its sound with recognised mouth movements,
 * without words. Playback is delayed by the lookahead. */

struct lip_network;

/* Shared by all live voices. */
struct live_pool {
    struct lip_network *network; /* NULL = live voices are disabled */
    unsigned most;               /* limit of live voices */
    unsigned key_most;           /* limit per quota key (speech_request.h); 0 = none */
    unsigned seconds;            /* limit of waiting sound per voice */
    unsigned count;
    struct live_voice *voices; /* the open ones */
};

enum {
    LIVE_PIECE_MS = 40,      /* minimum of a segment, for low latency */
    LIVE_PIECE_MAX_MS = 200, /* maximum of a segment */
    LIVE_PIECES = 2,         /* segments waiting for release */
    LIVE_STALL_MS = 200,     /* a gap up to this length is late, not lost */
    LIVE_MIN_PERCENT = 2, /* share of real time that must arrive within pipeline.open_seconds, or the voice is
                             closed */
};

/* Opens a live voice as the source of an utterance; `request` is a struct live_request, checked and copied.
 * Its sound comes as messages (live_audio above) through the source's write_sound. Returns NULL with *e:
 * "unknown-codec", "bad-field", "unknown-language", "unknown-engine", "too-many-voices", "voice-unavailable".
 */
struct speech_source *live_voice_open(const struct pipeline *pipeline, void *request,
                                      const struct synthesis_callbacks *callbacks, void *ctx,
                                      struct error *e);

#endif
