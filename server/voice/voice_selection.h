/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who says what in a score: chosen before it is spoken, by somebody who knows languages and folders. */
#ifndef FACCIA_VOICE_VOICE_SELECTION_H
#define FACCIA_VOICE_VOICE_SELECTION_H

#include "server/voice/voice_pool.h"

/* For each item of a score. */
struct voice_selection {
    const struct voice **voices; /* of texts */
    char **sounds;               /* of SCORE_AUDIO: the file; NULL = its alternate content is spoken */
    size_t count, cap;
};

struct voice_selection *voice_selection_new(size_t count);

/* Moves what `more` has behind what is there. */
void voice_selection_append(struct voice_selection *selection, struct voice_selection *more);
void voice_selection_free(struct voice_selection *selection);

/* A part of a sentence that one voice speaks, or a sound, or silence. */
struct voice_part {
    enum { PART_TEXT, PART_SOUND, PART_SILENCE } kind;
    size_t first, count; /* items; of a sound or a silence: it and the marks around */
    size_t instead_of; /* this part is spoken when that part, a sound, cannot be played; SIZE_MAX = always */
};

/* Cuts a sentence into parts, in order. The caller frees them. */
struct voice_part *voice_selection_parts(const struct voice_selection *selection, const struct score *score,
                                         size_t sentence, size_t *count);

#endif
