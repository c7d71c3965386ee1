/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A synthesis: one utterance on its way through markup, voice and face, sentence by sentence. What comes out
 * are segments: a sentence's audio with its face track. Segments come as soon as they are ready, in order,
 * and only a few ahead of what has been released. */
#ifndef FACCIA_SYNTHESIS_SYNTHESIS_H
#define FACCIA_SYNTHESIS_SYNTHESIS_H

#include "server/base/metrics.h"
#include "server/base/suggest.h"
#include "server/face/high_level.h"
#include "server/face/packs/speech_packs.h"
#include "server/normalize/normalizers.h"
#include "server/synthesis/media_segment.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/speech_request.h"
#include "server/voice/voice_pool.h"

/* Whether there is a pack for that language, or, of those that share the general one, a voice. */
bool synthesis_can_speak(const struct pipeline *pipeline, const char *lang);

struct synthesis;

struct synthesis_callbacks {
    void (*segment)(void *ctx, struct media_segment segment);
    /* A sentence could not be spoken, or (warning) something of the text was not acted on. */
    void (*problem)(void *ctx, const struct error *e, bool warning);
    /* No segment follows. spoken = how many came. */
    void (*finished)(void *ctx, size_t spoken);
};

/* Checks the request, which is copied. NULL with *e when it cannot be met. While voices start that could be
 * the one that it gets, the speech waits for them (voice_pool_settled): until then it has no voice and no
 * language. What is wrong then, or inside a long text (struct pipeline), is found later: the callbacks say it
 * as a problem, and then that nothing was spoken. */
struct synthesis *synthesis_open(const struct pipeline *pipeline, const struct speech_request *request,
                                 const struct synthesis_callbacks *callbacks, void *ctx, struct error *e);

/* Begins. Callbacks come later, from the loop; none after synthesis_free, which may be called from within
 * one.
 */
void synthesis_start(struct synthesis *synthesis);

/* Before the start: what has been handed on of a text with marks is kept, as far as it is short, so that
 * synthesis_seek may come back to it and nothing is spoken twice. */
void synthesis_keep(struct synthesis *synthesis);
void synthesis_free(struct synthesis *synthesis);

/* Of a request that is `open`, whose text is still being written: adds to it, bytes of UTF-8. -1 with *e, and
 * nothing is added: "bad-utf8", "nul" (byte of the whole text), "text-too-long" above `most` bytes in all.
 * What is wrong with markup comes as a problem; nothing behind that is spoken. */
int synthesis_write(struct synthesis *synthesis, const char *text, size_t size, size_t most, struct error *e);

/* What was written is spoken without waiting for more, as far as it is whole; nothing more will be written.
 * Both do nothing to another request. */
void synthesis_flush(struct synthesis *synthesis);
void synthesis_close(struct synthesis *synthesis);

/* Whether more may be written; and whether all that was written has been handed on, so that nothing can be
 * heard until there is more. */
bool synthesis_is_open(const struct synthesis *synthesis);
bool synthesis_awaits_text(const struct synthesis *synthesis);

/* Silence of so many ms to be heard meanwhile; what is handed on later comes behind it. */
struct media_segment synthesis_wait(struct synthesis *synthesis, unsigned ms);

/* One segment has been used up: another may come. */
void synthesis_release(struct synthesis *synthesis);

/* Goes on elsewhere: the segments that come next are those from `sentence` on, the first of them from its
 * mark of that name on (NULL: from its beginning), and its first sample to be heard is `sample` of the
 * speech. What has been spoken already and is needed there is not spoken again: what waits to be handed on,
 * and what is kept. `held` segments that were handed on, and have not been released, remain to be released.
 */
void synthesis_seek(struct synthesis *synthesis, size_t sentence, const char *mark, uint32_t sample,
                    size_t held);

/* For the sentences that are begun after this: words per minute, 40..500. */
void synthesis_set_rate(struct synthesis *synthesis, double rate);

/* The sentence in which the first mark of that name stands. */
bool synthesis_find_mark(const struct synthesis *synthesis, const char *name, size_t *sentence);
void synthesis_near_marks(const struct synthesis *synthesis, struct suggestions *near);

/* Whether the text has been read, all of it: false while a long one is, and when it cannot be read. */
bool synthesis_is_read(const struct synthesis *synthesis);

size_t synthesis_sentences(const struct synthesis *synthesis); /* how many there are; 0 until it is read */
size_t synthesis_next(const struct synthesis *synthesis);      /* which one is handed on next */
const char *
synthesis_entry(const struct synthesis *synthesis); /* the mark at which that is entered, or NULL */

const struct voice *synthesis_voice(const struct synthesis *synthesis);
const char *synthesis_lang(const struct synthesis *synthesis);
const char *synthesis_engine(const struct synthesis *synthesis);
const char *synthesis_markup(const struct synthesis *synthesis); /* what the text is: "plain", "ssml"... */
/* As it was asked for; its text is UTF-8 now. */
const struct speech_request *synthesis_request(const struct synthesis *synthesis);

#endif
