/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who says what in a score: chosen before it is spoken, by somebody who knows languages and folders. */
#ifndef FACCIA_VOICE_CAST_H
#define FACCIA_VOICE_CAST_H

#include "server/voice/pool.h"

/* For each item of a score. */
struct cast {
    const struct voice **voices; /* of texts */
    char **sounds;               /* of SCORE_AUDIO: the file; NULL = its alternate content is spoken */
    size_t count;
};

struct cast *cast_new(size_t count);
void cast_free(struct cast *cast);

/* A part of a sentence that one voice speaks, or a sound, or silence. */
struct part {
    enum { PART_TEXT, PART_SOUND, PART_SILENCE } kind;
    size_t first, count; /* items; of a sound or a silence: it and the marks around */
    size_t instead_of; /* this part is spoken when that part, a sound, cannot be played; SIZE_MAX = always */
};

/* Cuts a sentence into parts, in order. The caller frees them. */
struct part *cast_parts(const struct cast *cast, const struct score *score, size_t sentence, size_t *count);

#endif
