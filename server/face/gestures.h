/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An utterance as the face has to show it: phones of the pack and pauses, in order, with times in seconds. */
#ifndef FACCIA_FACE_GESTURES_H
#define FACCIA_FACE_GESTURES_H

#include "server/face/speech_pack.h"
#include "server/voice/utterance.h"

struct gesture {
    const struct speech_phone *phone; /* NULL = pause */
    double start, end;                /* s */
    double stress;                    /* 0 none .. 1 primary */
    unsigned phones;                  /* of the utterance that it stands for: 2 for a geminate said as two */
};

struct gestures {
    struct gesture *items;
    size_t count, cap;
    double end; /* s, of the audio */
};

/* Diphthongs are cut into their parts; equal consonants that follow each other become one (geminates), as do
 * pauses. Pauses under 40 ms belong to the phone before them. Phones that the pack lacks are reported once
 * each through warn (may be NULL). */
void gestures_from(const struct speech_pack *pack, const struct utterance *u,
                   void (*warn)(void *ctx, const char *message), void *ctx, struct gestures *out);
void gestures_free(struct gestures *g);

#endif
