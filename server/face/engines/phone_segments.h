/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sentence as the face has to show it: phones of the pack and pauses, in order, with times in seconds. */
#ifndef FACCIA_FACE_ENGINES_PHONE_SEGMENTS_H
#define FACCIA_FACE_ENGINES_PHONE_SEGMENTS_H

#include "server/face/packs/speech_pack_content.h"
#include "server/voice/sentence_audio.h"

struct phone_segment {
    const struct speech_phone *phone; /* NULL = pause */
    double start, end;                /* s */
    double stress;                    /* 0 none .. 1 primary */
    unsigned phones;                  /* of the sentence that it stands for: 2 for a geminate said as two */
};

struct phone_segments {
    struct phone_segment *items;
    size_t count, cap;
    double end; /* s, of the audio */
};

/* Diphthongs are cut into their parts; equal consonants that follow each other become one (geminates), as do
 * pauses. Pauses under 40 ms belong to the phone before them. Phones that the pack lacks are reported once
 * each through warn (may be NULL). */
void phone_segments_from(const struct speech_pack *pack, const struct sentence_audio *u,
                         void (*warn)(void *ctx, const char *message), void *ctx, struct phone_segments *out);
void phone_segments_free(struct phone_segments *g);

#endif
