/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The library's works, spoken by one voice before anybody asks, so that the voices' cache has their
 * sentences: section after section, while the voice has nothing else to do (VOICE_PRIORITY_BACKGROUND). */
#ifndef FACCIA_PUBLISH_SPEAK_AHEAD_H
#define FACCIA_PUBLISH_SPEAK_AHEAD_H

#include "server/library/library.h"
#include "server/synthesis/pipeline.h"
#include <stdint.h>

struct speak_ahead;

/* Begins with the works in the voice's language, when the pipeline's loop runs, and looks for new and changed
 * ones from time to time. voice: an id; most: bytes of sound after which no more is spoken; text_bytes:
 * longest text. All is borrowed, the voice's id is not. The library tells how far it is. */
struct speak_ahead *speak_ahead_open(const struct pipeline *pipeline, struct library *library,
                                     const char *voice, uint64_t most, size_t text_bytes);

/* Before the voices are closed. NULL is fine. */
void speak_ahead_close(struct speak_ahead *ahead);

#endif
