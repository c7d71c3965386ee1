/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A synthesis: one utterance passing through markup, voice and face, sentence by sentence. Its output is
 * segments: a sentence's audio with its face track, in order, as soon as they are ready, and only a few
 * ahead of what has been released. */
#ifndef FACCIA_SYNTHESIS_SYNTHESIS_H
#define FACCIA_SYNTHESIS_SYNTHESIS_H

#include "server/base/metrics.h"
#include "server/base/suggest.h"
#include "server/face/engines/fapmap.h"
#include "server/face/packs/speech_pack.h"
#include "server/markup/speaker_runs.h"
#include "server/normalize/normalizers.h"
#include "server/synthesis/media_segment.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/speech_request.h"
#include "server/synthesis/speech_source.h"
#include "server/voice/voice_pool.h"

/* Tells whether the language has a pack, or, if it shares the general one, a voice. */
bool synthesis_can_speak(const struct pipeline *pipeline, const char *lang);

struct synthesis;

/* Checks and copies the request. Returns NULL with *e when it cannot be met. While plugins start that
 * could provide its voice (voice_pool_settled), the utterance waits and has no voice or language. Errors
 * found then, or inside a long text (struct pipeline), are reported as a problem, followed by `finished`
 * with nothing spoken. */
struct synthesis *synthesis_open(const struct pipeline *pipeline, const struct speech_request *request,
                                 const struct synthesis_callbacks *callbacks, void *ctx, struct error *e);

/* The same, as the source of an utterance; `request` is a struct speech_request. */
struct speech_source *synthesis_open_source(const struct pipeline *pipeline, void *request,
                                            const struct synthesis_callbacks *callbacks, void *ctx,
                                            struct error *e);

/* Starts. Callbacks come later, from the loop; none after synthesis_free, which may be called from within
 * one. */
void synthesis_start(struct synthesis *synthesis);

/* Keeps delivered sentences of a text with marks, within KEPT_SPEECH_BYTES, so that synthesis_seek can
 * return to them without speaking them again. Call before the start. */
void synthesis_keep(struct synthesis *synthesis);
void synthesis_free(struct synthesis *synthesis);

/* Appends UTF-8 to the text of an `open` request. Returns -1 with *e and adds nothing: "bad-utf8", "nul"
 * (with the byte of the whole text), "text-too-long" above `most` bytes in all. Markup errors come as
 * problems; nothing after them is spoken. */
int synthesis_write(struct synthesis *synthesis, const char *text, size_t size, size_t most, struct error *e);

/* synthesis_flush speaks everything written so far, as far as its markup is complete; synthesis_close ends
 * the text. Both do nothing unless the request is `open`. */
void synthesis_flush(struct synthesis *synthesis);
void synthesis_close(struct synthesis *synthesis);

/* Releases one segment, so that another may come. */
void synthesis_release(struct synthesis *synthesis);

/* Continues at `sentence`, entered at its mark of that name (NULL: at its beginning), with `sample` as the
 * next sample heard. Finished and kept sentences are reused. The `held` segments already delivered must
 * still be released. */
void synthesis_seek(struct synthesis *synthesis, size_t sentence, const char *mark, uint32_t sample,
                    size_t held);

/* Sets words per minute, 40..500, for sentences not yet started. */
void synthesis_set_rate(struct synthesis *synthesis, double rate);

/* Finds the sentence with the first mark of that name. Returns false if there is none. */
bool synthesis_find_mark(const struct synthesis *synthesis, const char *name, size_t *sentence);
void synthesis_near_marks(const struct synthesis *synthesis, struct suggestions *near);

size_t
synthesis_sentences(const struct synthesis *synthesis); /* number of sentences; 0 until the text is parsed */
size_t synthesis_next(const struct synthesis *synthesis);       /* index of the next one delivered */
const char *synthesis_entry(const struct synthesis *synthesis); /* mark at which it is entered, or NULL */

/* The script that is spoken; NULL until the text is parsed. A delivered sentence is in words. */
const struct score *synthesis_score(const struct synthesis *synthesis);

const struct voice *synthesis_voice(const struct synthesis *synthesis);
const char *synthesis_lang(const struct synthesis *synthesis);
const char *synthesis_engine(const struct synthesis *synthesis);
const char *synthesis_markup(const struct synthesis *synthesis); /* detected markup: "plain", "ssml"... */
/* Who speaks the byte of the text; NULL: nobody in particular. */
const struct speaker *synthesis_speaker(const struct synthesis *synthesis, size_t byte);

/* True if the request says who speaks. */
bool synthesis_has_speakers(const struct synthesis *synthesis);

/* The request, with its text converted to UTF-8. */
const struct speech_request *synthesis_request(const struct synthesis *synthesis);

#endif
