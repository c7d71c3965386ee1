/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speaks the library's works in advance with one voice, so that the cache has their sentences, section by
 * section, while the voice is idle (VOICE_PRIORITY_BACKGROUND). */
#ifndef FACCIA_LIBRARY_PUBLISH_PRERENDER_H
#define FACCIA_LIBRARY_PUBLISH_PRERENDER_H

#include "server/library/library.h"
#include "server/synthesis/pipeline.h"
#include <stdint.h>

struct prerender;

/* Starts with the works in the voice's language once the loop runs, and checks regularly for new and
 * changed works. voice: an id, copied; most: limit in bytes of sound; text_bytes: longest text. Everything
 * else is borrowed. Progress goes to library_set_prerender. */
struct prerender *prerender_open(const struct pipeline *pipeline, struct library *library, const char *voice,
                                 uint64_t most, size_t text_bytes);

/* Call before the voices are closed. NULL is ignored. */
void prerender_close(struct prerender *prerender);

#endif
