/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A live voice: sound from a client, shown with mouth movements recognised from it. */
#ifndef FACCIA_SYNTHESIS_LIVE_VOICE_H
#define FACCIA_SYNTHESIS_LIVE_VOICE_H

#include "server/synthesis/live_request.h"
#include "server/synthesis/synthesis.h"

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

struct live_voice;

/* Checks and copies the request. Returns NULL with *e: "unknown-codec", "bad-field", "unknown-language",
 * "unknown-engine", "too-many-voices". Segments and problems come as for a synthesis, also within the
 * calls below. */
struct live_voice *live_voice_open(const struct pipeline *pipeline, const struct live_request *request,
                                   const struct synthesis_callbacks *callbacks, void *ctx, struct error *e);

/* Starts playing. Drops sound received earlier. */
void live_voice_start(struct live_voice *live);

/* Drops the backlog after a pause. */
void live_voice_catch_up(struct live_voice *live);

/* Adds a message with sound (live_audio above). */
void live_voice_write(struct live_voice *live, const uint8_t *bytes, size_t size);

/* Ends the voice: no more sound follows. */
void live_voice_close(struct live_voice *live);
bool live_voice_is_open(const struct live_voice *live);

/* Tells whether more sound may come. */
bool live_voice_awaits(const struct live_voice *live);

/* Inserts `ms` of silence, in which the lips return to rest. */
void live_voice_wait(struct live_voice *live, unsigned ms);
bool live_voice_stalls(const struct live_voice *live); /* silence was inserted and nothing has come since */
void live_voice_release(struct live_voice *live);
void live_voice_free(struct live_voice *live);

const struct speech_request *live_voice_request(const struct live_voice *live);
const char *live_voice_lang(const struct live_voice *live);
const char *live_voice_engine(const struct live_voice *live);
unsigned live_voice_lookahead(const struct live_voice *live);

#endif
