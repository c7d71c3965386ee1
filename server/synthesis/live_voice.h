/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What somebody asks for who speaks himself: how his voice comes, and how it is to be shown. */
#ifndef FACCIA_SYNTHESIS_LIVE_VOICE_H
#define FACCIA_SYNTHESIS_LIVE_VOICE_H

#include "server/synthesis/speech_request.h"
#include "server/synthesis/synthesis.h"

enum {
    LIVE_RATE_MIN = 8000,
    LIVE_RATE_MAX = 96000,
    LIVE_CHANNELS_MAX = 8,
    LIVE_LOOKAHEAD = 80, /* ms, unless another is asked for */
};

enum live_codec { LIVE_PCM, LIVE_OPUS };

/* "pcm_s16le" and "opus", NULL-terminated, in the order of their enum. */
extern const char *const live_codecs[];

struct live_request {
    const struct speech_request *speech; /* what is no matter of its text */
    enum live_codec codec;
    unsigned rate, channels, lookahead; /* Hz; ms */
};

/* -1 with *e ("unknown-codec", field "codec"). "pcm" will do, too. */
int live_codec_find(const char *name, enum live_codec *codec, struct error *e);

/* Whether sound comes like that: -1 with *e ("bad-field"). */
int live_request_check(const struct live_request *request, struct error *e);

/* The bytes of somebody's voice, as a client sends them, become mono samples. */

struct live_audio;

/* NULL with *e: as live_request_check. */
struct live_audio *live_audio_new(const struct live_request *request, struct error *e);
void live_audio_free(struct live_audio *sound);

/* Takes a message: signed 16 bit samples, little endian, of all channels by turns, which may be cut anywhere;
 * or one Opus packet. give gets its samples, at most LIVE_BLOCK at a time. -1 with *e ("bad-sound", at the
 * byte of all that came) when it is no packet: what goes on in its place is what was heard before. */
enum { LIVE_BLOCK = 8192 };
int live_audio_read(struct live_audio *sound, const uint8_t *bytes, size_t size,
                    void (*give)(void *ctx, const int16_t *samples, size_t count), void *ctx,
                    struct error *e);

/* Nothing more comes: -1 with *e when the last sample is not whole. */
int live_audio_end(const struct live_audio *sound, struct error *e);

/* Somebody's voice, while it speaks, as segments like those of a speech: its sound, and the mouth that goes
 * with it. Nobody knows its words. What is heard is delayed by the lookahead, together with the face. */

struct lip_network;

/* What all that are heard have in common. */
struct live_pool {
    struct lip_network *network; /* NULL: none can be heard */
    unsigned most;                /* at a time */
    unsigned payer_most;          /* of one payer (speech_request.h); 0 = no limit of its own */
    unsigned seconds;             /* of sound that may wait, of each */
    unsigned count;
    struct live_voice *voices; /* those that are counted */
};

enum {
    LIVE_PIECE_MS = 40,      /* least of a segment, so that it leaves soon */
    LIVE_PIECE_MAX_MS = 200, /* and most */
    LIVE_PIECES = 2,         /* that wait to be used up */
    LIVE_STALL_MS = 200,     /* so late a piece is late, not lost */
    LIVE_MIN_PERCENT = 2,    /* of real time must come within pipeline.open_seconds, or nobody speaks */
};

struct live_voice;

/* Checks the request, which is copied. NULL with *e: "unknown-codec", "bad-field", "unknown-language",
 * "unknown-engine", "too-many-voices". Segments and problems come as those of a speech; within the calls
 * below, too. */
struct live_voice *live_voice_open(const struct pipeline *pipeline, const struct live_request *request,
                                   const struct synthesis_callbacks *callbacks, void *ctx, struct error *e);

/* Its turn has come: what was said before is passed over. */
void live_voice_start(struct live_voice *live);

/* The same after a pause. */
void live_voice_catch_up(struct live_voice *live);

/* A message with sound has come (live_audio.h). */
void live_voice_write(struct live_voice *live, const uint8_t *bytes, size_t size);

/* Nothing more comes. */
void live_voice_close(struct live_voice *live);
bool live_voice_is_open(const struct live_voice *live);

/* Whether more of it can be heard. */
bool live_voice_awaits(const struct live_voice *live);

/* Nothing has come for long: so many ms of silence, in which the lips go to rest. */
void live_voice_wait(struct live_voice *live, unsigned ms);
bool live_voice_stalls(const struct live_voice *live); /* it was, and still nothing has come */
void live_voice_release(struct live_voice *live);
void live_voice_free(struct live_voice *live);

const struct speech_request *live_voice_request(const struct live_voice *live);
const char *live_voice_lang(const struct live_voice *live);
const char *live_voice_engine(const struct live_voice *live);
unsigned live_voice_lookahead(const struct live_voice *live);

#endif
