/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places the phones of an aligned recording more closely than the warp does: a segmental model (M. Ostendorf,
 * V. Digalakis and O. Kimball, IEEE Trans. Speech and Audio Processing 4, 1996) whose phones are learnt from
 * the recording itself, beginning with the synthetic voice's. Needs no other data, so it works in any
 * language. */
#ifndef FACCIA_LIBRARY_ALIGN_REFINE_H
#define FACCIA_LIBRARY_ALIGN_REFINE_H

#include "server/library/align/mfcc.h"
#include "server/library/align/reference.h"
#include "server/library/align/sound_classes.h"
#include <stdatomic.h>

/* A phone of the reference, and where the warp has put it. */
struct refine_phone {
    char ipa[PHONE_NAME_BYTES];
    bool word, pause;    /* begins a word; the reference pauses before it */
    size_t from, to;     /* frames of the reference */
    size_t start, end;   /* frames of the recording */
    double begins, ends; /* result: frames of the recording */
    float sure;          /* result: probability that it begins within 0.1 s of there */
    float heard; /* result: mean log probability of its class where it lies, 0 at most; -1 = unknown */
};

/* What is known of the speaker's phones; kept from one stretch of a recording to the next. */
struct refine_model;
struct refine_model *refine_model_new(void);
void refine_model_free(struct refine_model *model);

/* Moves the phones. They stay in order and inside the recording, and none moves by more than a second or so.
 * False when it was stopped or there is nothing to do. */
bool refine(struct refine_model *model, const struct features *recording, const struct features *reference,
            const struct sound_likelihoods *heard, struct refine_phone *phones, size_t count,
            const atomic_bool *stop);

#endif
