/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A speech: one request on its way through markup, voice and face, sentence by sentence. What comes out are
 * scenes: a sentence's audio with its face track. Scenes come as soon as they are ready, in order, and only a
 * few ahead of what has been released. */
#ifndef FACCIA_STREAM_SPEECH_H
#define FACCIA_STREAM_SPEECH_H

#include "server/base/metrics.h"
#include "server/base/near.h"
#include "server/face/high_level.h"
#include "server/face/packs.h"
#include "server/face/track.h"
#include "server/reading/readings.h"
#include "server/stream/effort.h"
#include "server/stream/request.h"
#include "server/voice/pool.h"

/* What all speeches share. Borrowed. */
struct studio {
    uv_loop_t *loop;
    struct voice_pool *voices;
    const struct speech_packs *packs;
    const struct expressions *expressions;
    const struct face_high_level *high_level; /* NULL = FAP 1 and 2 of recordings move nothing */
    const struct readings *readings;          /* NULL = say-as is left to the voices */
    const char *default_lang;
    const char *sounds;      /* folder of sound files that texts may name; NULL = none */
    struct metrics *metrics; /* NULL = nobody counts */
    struct effort *effort;   /* of the sound; NULL = the best */
    /* Texts of so many bytes and more are read in another thread, so that the loop is free; 0 = none. */
    size_t long_text;
};

/* Whether there is a pack for that language, or, of those that share the general one, a voice. */
bool speech_can_speak(const struct studio *studio, const char *lang);

/* One spoken sentence, or a piece of a recording. The receiver of a scene owns it. */
struct scene {
    struct utterance *utterance;
    struct face_track *track; /* NULL: the face is in frames */
    int64_t start; /* its first sample, counted from the speech's beginning; below 0 when `skip` hides that */
    uint32_t skip; /* samples at its beginning that are not to be heard */
    size_t sentence;                /* which one it is, from 0 */
    const struct fap_frame *frames; /* of the whole recording, borrowed; the last one stays */
    size_t frame_count;
};

void scene_free(struct scene *scene);

/* The frame with number k of the speech, k / fps seconds from its beginning. */
void scene_frame(const struct scene *scene, double fps, uint32_t k, struct fap_frame *frame);

/* The first frame that does not lie before that sample of the speech. */
uint32_t frame_from_sample(uint64_t sample, uint32_t sample_rate, double fps);

struct speech;

struct speech_callbacks {
    void (*scene)(void *ctx, struct scene scene);
    /* A sentence could not be spoken, or (warning) something of the text was not acted on. */
    void (*problem)(void *ctx, const struct error *e, bool warning);
    /* No scene follows. spoken = how many came. */
    void (*finished)(void *ctx, size_t spoken);
};

/* Checks the request, which is copied. NULL with *e when it cannot be met. While voices start that could be the
 * one that it gets, the speech waits for them (voice_pool_settled): until then it has no voice and no language.
 * What is wrong then, or inside a long text (struct studio), is found later: the callbacks say it as a problem,
 * and then that nothing was spoken. */
struct speech *speech_open(const struct studio *studio, const struct speech_request *request,
                           const struct speech_callbacks *callbacks, void *ctx, struct error *e);

/* Begins. Callbacks come later, from the loop; none after speech_free, which may be called from within one.
 */
void speech_start(struct speech *speech);

/* Before the start: `face` is asked before a scene's face is made. It may change how that is to be, so that
 * it goes on from the face before (seed, begin, life) and shows a mood. */
void speech_direct_face(struct speech *speech, void (*face)(void *ctx, struct face_options *options));
void speech_free(struct speech *speech);

/* One scene has been used up: another may come. */
void speech_release(struct speech *speech);

/* Goes on elsewhere: the scenes that come next are those from `sentence` on, the first of them from its mark
 * of that name on (NULL: from its beginning), and its first sample to be heard is `sample` of the speech.
 * What was not handed on is forgotten; `held` scenes that were, and have not been released, remain to be
 * released. */
void speech_seek(struct speech *speech, size_t sentence, const char *mark, uint32_t sample, size_t held);

/* For the sentences that are begun after this: words per minute, 40..500. */
void speech_set_rate(struct speech *speech, double rate);

/* The sentence in which the first mark of that name stands. */
bool speech_find_mark(const struct speech *speech, const char *name, size_t *sentence);
void speech_near_marks(const struct speech *speech, struct near *near);

/* Whether the text has been read, all of it: false while a long one is, and when it cannot be read. */
bool speech_is_read(const struct speech *speech);

size_t speech_sentences(const struct speech *speech);  /* how many there are; 0 until it is read */
size_t speech_next(const struct speech *speech);       /* which one is handed on next */
const char *speech_entry(const struct speech *speech); /* the mark at which that is entered, or NULL */

const struct voice *speech_voice(const struct speech *speech);
const char *speech_lang(const struct speech *speech);
const char *speech_engine(const struct speech *speech);
const char *speech_markup(const struct speech *speech); /* what the text is: "plain", "ssml"... */
/* As it was asked for; its text is UTF-8 now. */
const struct speech_request *speech_request(const struct speech *speech);

#endif
