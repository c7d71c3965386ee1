/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speaks a sentence of a score that several voices and sound files may share, and joins the result into
 * one sentence's audio. */
#ifndef FACCIA_VOICE_SENTENCE_H
#define FACCIA_VOICE_SENTENCE_H

#include "server/base/error.h"
#include "server/base/work/reader_process.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/voice_pool.h"

/* Longer sounds are cut; larger files are refused. */
enum { SOUND_SECONDS = 60, SOUND_BYTES_MAX = 64 << 20, SOUND_CHANNELS_MAX = 16 };

/* Resolves src, a relative path below the folder (percent signs are not decoded, URLs are refused). The
 * caller frees the result. Returns NULL with *e ("no-sound") when the file does not exist or must not be
 * used; a NULL folder has no sounds. */
char *sound_find(const char *folder, const char *src, struct error *e);

/* Reads a sound file (sound_reader.h), mixed to mono and scaled by volume, as a sentence's audio with
 * a single pause. Returns NULL with *e when it cannot be read. Stops early when *given_up, which may be
 * NULL, is set. Callable from any thread. */
struct sentence_audio *sound_read(const struct reader *reader, const char *path, double volume,
                                  uint32_t sample_rate, const atomic_bool *given_up, struct error *e);

/* The voice of each text and the file of each sound of a score, chosen before it is spoken by the caller,
 * who knows languages and folders. */

struct voice_selection {
    const struct voice **voices; /* of each SCORE_TEXT */
    char **sounds;               /* of each SCORE_AUDIO; NULL = its alternate content is spoken */
    size_t count, cap;
};

struct voice_selection *voice_selection_new(size_t count);

/* Appends `more`, whose contents are moved. */
void voice_selection_append(struct voice_selection *selection, struct voice_selection *more);
void voice_selection_free(struct voice_selection *selection);

/* A part of a sentence: text spoken by one voice, a sound, or silence. */
struct voice_part {
    enum { PART_TEXT, PART_SOUND, PART_SILENCE } kind;
    size_t first, count; /* items; a sound or silence includes the marks around it */
    size_t instead_of;   /* spoken only when that part, a sound, cannot be played; SIZE_MAX = always */
};

/* Cuts a sentence into parts, in order. The caller frees the array. */
struct voice_part *voice_selection_parts(const struct voice_selection *selection, const struct score *score,
                                         size_t sentence, size_t *count);

struct sentence;

/* Speaks a sentence. request->voice speaks text without a voice of its own and sets the sample rate. The
 * score and the selection must outlive the sentence. Exactly one callback follows, later, unless the
 * sentence is cancelled. */
struct sentence *sentence_speak(struct voice_pool *pool, uv_loop_t *loop,
                                const struct sentence_request *request,
                                const struct voice_selection *selection,
                                const struct voice_callbacks *callbacks, void *ctx);

/* Frees the sentence; no callback follows. */
void sentence_cancel(struct sentence *sentence);

#endif
