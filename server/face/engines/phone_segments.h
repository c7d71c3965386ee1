/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sentence as the face shows it: phones of the pack and pauses, in order, with times in seconds. */
#ifndef FACCIA_FACE_ENGINES_PHONE_SEGMENTS_H
#define FACCIA_FACE_ENGINES_PHONE_SEGMENTS_H

#include "server/face/packs/speech_pack_content.h"
#include "server/voice/sentence_audio.h"

struct phone_segment {
    const struct speech_phone *phone; /* NULL = pause */
    double start, end;                /* s */
    double stress;                    /* 0 none .. 1 primary */
    unsigned phones; /* number of the sentence's phones it covers: 2 for a geminate reported as two */
};

struct phone_segments {
    struct phone_segment *items;
    size_t count, cap;
    double end; /* s: end of the audio */
};

/* Splits diphthongs into their parts and merges equal consecutive consonants (geminates) and pauses.
 * Pauses under 40 ms belong to the previous phone. Phones missing in the pack are reported once each
 * through warn, which may be NULL. */
void phone_segments_from(const struct speech_pack *pack, const struct sentence_audio *u,
                         void (*warn)(void *ctx, const char *message), void *ctx, struct phone_segments *out);
void phone_segments_free(struct phone_segments *g);

#endif
