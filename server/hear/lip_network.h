/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be told apart by looking at a mouth; models/tools/hear/sounds.py says which phones are which. */
#ifndef FACCIA_HEAR_LIP_NETWORK_H
#define FACCIA_HEAR_LIP_NETWORK_H

#include "server/base/error.h"
#include "server/face/packs/shape_table.h"
#include "server/hear/lip_features.h"

enum hear_class {
    HEAR_SILENCE,
    HEAR_CLOSED, /* p b m */
    HEAR_TEETH,  /* f v */
    HEAR_ROUNDED,
    HEAR_DENTAL,
    HEAR_HISS,
    HEAR_TIP,
    HEAR_LIQUID,
    HEAR_BACK,
    HEAR_OPEN,
    HEAR_MIDDLE,
    HEAR_MIDDLE_ROUND,
    HEAR_CLOSE,
    HEAR_CLOSE_ROUND,
    HEAR_CLASSES
};

struct hear_class_name {
    const char *name;        /* "closed" */
    const char *ipa, *sampa; /* the phone that stands for all of them; "" and "_" of silence */
};

extern const struct hear_class_name hear_classes[HEAR_CLASSES];

/* A small recurrent network that tells from features, as they come, what a mouth does: a convolution over the
 * last frames, two layers of gated recurrent units (K. Cho et al., EMNLP 2014), and for each lookahead a
 * head for the sounds and one for the mouth; beside them one that tells voices from music. models/tools/hear
 * trains it; its file is described in models/hear/README.md. */

enum { HEAR_HEADS_MOST = 8 };

struct hear_network; /* immutable once loaded: many may listen with one */
struct hear_state;   /* of one who listens */

/* NULL with *e (bad-network) when the file is not as it must be. */
struct hear_network *hear_network_load(const char *path, struct error *e);
void hear_network_free(struct hear_network *network);

/* By how many frames each head answers late, rising; returns how many there are. */
size_t hear_network_delays(const struct hear_network *network, unsigned delays[HEAR_HEADS_MOST]);

struct hear_state *hear_state_new(const struct hear_network *network);
void hear_state_free(struct hear_state *state);

/* What it tells of the instant that lies a head's delay ago. */
struct hear_answer {
    float likely[HEAR_CLASSES]; /* how likely each class is; they add up to 1 */
    float mouth[PARAM_COUNT];   /* the articulatory parameters, mm */
    float voice; /* of now: how likely it is that anybody speaks at all: the logarithm of the odds */
};

/* Takes the next frame. */
void hear_state_step(struct hear_state *state, const float frame[HEAR_FEATURES], size_t head,
                     struct hear_answer *answer);

#endif
