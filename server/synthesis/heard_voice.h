/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Somebody's voice, while it speaks, as segments like those of a speech: its sound, and the mouth that goes
 * with it. Nobody knows its words. What is heard is delayed by the lookahead, together with the face. */
#ifndef FACCIA_SYNTHESIS_HEARD_VOICE_H
#define FACCIA_SYNTHESIS_HEARD_VOICE_H

#include "server/synthesis/heard_request.h"
#include "server/synthesis/synthesis.h"

struct hear_network;

/* What all that are heard have in common. */
struct heard_pool {
    struct hear_network *network; /* NULL: none can be heard */
    unsigned most;                /* at a time */
    unsigned payer_most;          /* of one payer (speech_request.h); 0 = no limit of its own */
    unsigned seconds;             /* of sound that may wait, of each */
    unsigned count;
    struct heard_voice *voices; /* those that are counted */
};

enum {
    HEARD_PIECE_MS = 40,       /* least of a segment, so that it leaves soon */
    HEARD_PIECE_MOST_MS = 200, /* and most */
    HEARD_PIECES = 2,          /* that wait to be used up */
    HEARD_STALL_MS = 200,      /* so late a piece is late, not lost */
    HEARD_LEAST_PERCENT = 2,   /* of real time must come within pipeline.open_seconds, or nobody speaks */
};

struct heard_voice;

/* Checks the request, which is copied. NULL with *e: "unknown-codec", "bad-field", "unknown-language",
 * "unknown-engine", "too-many-voices". Segments and problems come as those of a speech; within the calls
 * below, too. */
struct heard_voice *heard_voice_open(const struct pipeline *pipeline, const struct heard_request *request,
                                     const struct synthesis_callbacks *callbacks, void *ctx, struct error *e);

/* Its turn has come: what was said before is passed over. */
void heard_voice_start(struct heard_voice *heard);

/* The same after a pause. */
void heard_voice_catch_up(struct heard_voice *heard);

/* A message with sound has come (heard_sound.h). */
void heard_voice_write(struct heard_voice *heard, const uint8_t *bytes, size_t size);

/* Nothing more comes. */
void heard_voice_close(struct heard_voice *heard);
bool heard_voice_is_open(const struct heard_voice *heard);

/* Whether more of it can be heard. */
bool heard_voice_awaits(const struct heard_voice *heard);

/* Nothing has come for long: so many ms of silence, in which the lips go to rest. */
void heard_voice_wait(struct heard_voice *heard, unsigned ms);
bool heard_voice_stalls(const struct heard_voice *heard); /* it was, and still nothing has come */
void heard_voice_release(struct heard_voice *heard);
void heard_voice_free(struct heard_voice *heard);

const struct speech_request *heard_voice_request(const struct heard_voice *heard);
const char *heard_voice_lang(const struct heard_voice *heard);
const char *heard_voice_engine(const struct heard_voice *heard);
unsigned heard_voice_lookahead(const struct heard_voice *heard);

#endif
