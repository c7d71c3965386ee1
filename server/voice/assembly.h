/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a sentence's audio from the frames that a worker sends for it. The worker is not trusted: what
 * can be repaired is repaired, with a warning in the audio; anything else fails the sentence. */
#ifndef FACCIA_VOICE_ASSEMBLY_H
#define FACCIA_VOICE_ASSEMBLY_H

#include "server/base/error.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/voice_request.h"
#include "server/voice/wire.h"

/* Corrects the boundaries between phones where listeners hear them elsewhere than the voice reports: a
 * table by voice (models/boundaries.json, models/boundaries.md). */

/* The largest shift of a boundary, in ms, and as a share of the phone on either side. */
enum { BOUNDARY_MS_MAX = 60, BOUNDARY_PART = 3 /* a third */ };

struct boundary_table;
struct voice_boundaries; /* the rules of one voice */

/* Reads the file; the table is empty when the file does not exist. Returns NULL with *e ("bad-boundaries")
 * when it is invalid. */
struct boundary_table *boundary_table_load(const char *path, struct error *e);
void boundary_table_free(struct boundary_table *table);

/* Returns the rules of a voice by its id ("festival:lp"), or NULL if there are none or table is NULL. They
 * live as long as the table. */
const struct voice_boundaries *boundary_table_find(const struct boundary_table *table, const char *voice);

/* Shifts the boundaries between phones, and the words and marks with them. Phones stay adjacent and in
 * order and keep at least a third of their length; the total length stays the same. Does nothing if
 * boundaries is NULL. */
void boundaries_correct(const struct voice_boundaries *boundaries, struct sentence_audio *u);

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
