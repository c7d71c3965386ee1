/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a sentence's audio from what a worker says while it speaks one sentence. Nothing a worker says is
 * believed: what can be mended is mended, with a warning in the sentence's audio; what cannot fails the
 * sentence. */
#ifndef FACCIA_VOICE_ASSEMBLY_H
#define FACCIA_VOICE_ASSEMBLY_H

#include "server/base/error.h"
#include "server/voice/boundary_table.h"
#include "server/voice/plan.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/wire.h"

/* Bounds for one sentence: seconds of audio are ASSEMBLY_SECONDS and one for each byte of text and the breaks
 * asked for, together not more than ASSEMBLY_SECONDS_MAX; events likewise. */
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

/* The plan must outlive the assembly. */
struct assembly *assembly_new(const struct plan *plan);
void assembly_free(struct assembly *a);

/* Take the payload of an AUDIO or EVENTS frame. -1 with *e when the sentence cannot be saved: "voice-failed",
 * whose message is what the voice did ("sent broken audio"), or "text-too-long": the sound goes beyond the
 * bounds, which may be the text's doing. */
int assembly_audio(struct assembly *a, const struct wire_frame *frame, struct error *e);
int assembly_events(struct assembly *a, const struct wire_frame *frame, struct error *e);

/* the sentence's audio, when all has been said, which may be nothing: then it has no samples. lang and
 * sample_rate are the voice's; the rate counts where there was no audio. boundaries is what is known of where
 * the voice's phones are heard, or NULL. Once only; free the assembly after. */
struct sentence_audio *assembly_finish(struct assembly *a, const char *lang, uint32_t sample_rate,
                                       const struct voice_boundaries *boundaries);

#endif
