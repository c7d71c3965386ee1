/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speaks a sentence of a score with all who have a part in it: several voices, of several plugins perhaps,
 * and sounds. What comes is one sentence's audio. */
#ifndef FACCIA_VOICE_SENTENCE_H
#define FACCIA_VOICE_SENTENCE_H

#include "server/voice/voice_selection.h"

struct sentence;

/* request->voice is the one for what has no voice of its own, and its sample rate is that of what is joined.
 * The score and the selection must outlive the sentence. Exactly one callback follows, later, unless it is
 * cancelled. */
struct sentence *sentence_speak(struct voice_pool *pool, uv_loop_t *loop, const struct voice_request *request,
                                const struct voice_selection *selection,
                                const struct voice_callbacks *callbacks, void *ctx);

/* Forgets the sentence: no callback will come. */
void sentence_cancel(struct sentence *sentence);

#endif
