/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a sentence's audio from the frames that a worker sends for it. The worker is not trusted: what
 * can be repaired is repaired, with a warning in the audio; anything else fails the sentence. */
#ifndef FACCIA_VOICE_ASSEMBLY_H
#define FACCIA_VOICE_ASSEMBLY_H

#include "server/base/error.h"
#include "server/voice/boundary_table.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/voice_request.h"
#include "server/voice/wire.h"

/* Limits for one sentence. Audio: ASSEMBLY_SECONDS, plus one second per byte of text, plus the requested
 * breaks, at most ASSEMBLY_SECONDS_MAX in all. Events are limited the same way. */
enum {
    ASSEMBLY_SECONDS = 60,
    ASSEMBLY_SECONDS_MAX = 1800,
    ASSEMBLY_EVENTS = 4096,
    ASSEMBLY_EVENTS_PER_BYTE = 64,
    ASSEMBLY_WARNINGS = 16,
    ASSEMBLY_RATE_MIN = 8000, /* Hz */
    ASSEMBLY_RATE_MAX = 192000,
};

struct assembly;

/* The request must outlive the assembly. */
struct assembly *assembly_new(const struct voice_request *request);
void assembly_free(struct assembly *a);

/* Append the payload of an AUDIO or EVENTS frame. Return -1 with *e when the sentence cannot be saved:
 * "voice-failed", with a message that follows the voice's name ("sent broken audio"), or "text-too-long"
 * when the sound exceeds the limits, which may be the text's fault. */
int assembly_audio(struct assembly *a, const struct wire_frame *frame, struct error *e);
int assembly_events(struct assembly *a, const struct wire_frame *frame, struct error *e);

/* Returns the finished audio, which has no samples if the worker sent none. lang and sample_rate are the
 * voice's; the rate is used where no audio came. boundaries corrects phone times, and may be NULL. Call
 * once, then free the assembly. */
struct sentence_audio *assembly_finish(struct assembly *a, const char *lang, uint32_t sample_rate,
                                       const struct voice_boundaries *boundaries);

#endif
