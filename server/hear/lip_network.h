/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be told apart by looking at a mouth; models/tools/hear/sounds.py says which phones are which. */
#ifndef FACCIA_HEAR_LIP_NETWORK_H
#define FACCIA_HEAR_LIP_NETWORK_H

#include "server/base/error.h"
#include "server/face/packs/shape_table.h"
#include "server/hear/lip_features.h"

enum lip_class {
    LIP_SILENCE,
    LIP_CLOSED, /* p b m */
    LIP_TEETH,  /* f v */
    LIP_ROUNDED,
    LIP_DENTAL,
    LIP_HISS,
    LIP_TIP,
    LIP_LIQUID,
    LIP_BACK,
    LIP_OPEN,
    LIP_MIDDLE,
    LIP_MIDDLE_ROUND,
    LIP_CLOSE,
    LIP_CLOSE_ROUND,
    LIP_CLASSES
};

struct lip_class_name {
    const char *name;        /* "closed" */
    const char *ipa, *sampa; /* the phone that stands for all of them; "" and "_" of silence */
};

extern const struct lip_class_name lip_classes[LIP_CLASSES];

/* A small recurrent network that tells from features, as they come, what a mouth does: a convolution over the
 * last frames, two layers of gated recurrent units (K. Cho et al., EMNLP 2014), and for each lookahead a
 * head for the sounds and one for the mouth; beside them one that tells voices from music. models/tools/hear
 * trains it; its file is described in models/hear/README.md. */

enum { LIP_HEADS_MOST = 8 };

struct lip_network; /* immutable once loaded: many may listen with one */
struct lip_state;   /* of one who listens */

/* NULL with *e (bad-network) when the file is not as it must be. */
struct lip_network *lip_network_load(const char *path, struct error *e);
void lip_network_free(struct lip_network *network);

/* By how many frames each head answers late, rising; returns how many there are. */
size_t lip_network_delays(const struct lip_network *network, unsigned delays[LIP_HEADS_MOST]);

struct lip_state *lip_state_new(const struct lip_network *network);
void lip_state_free(struct lip_state *state);

/* What it tells of the instant that lies a head's delay ago. */
struct lip_answer {
    float likely[LIP_CLASSES]; /* how likely each class is; they add up to 1 */
    float mouth[PARAM_COUNT];  /* the articulatory parameters, mm */
    float voice; /* of now: how likely it is that anybody speaks at all: the logarithm of the odds */
};

/* Takes the next frame. */
void lip_state_step(struct lip_state *state, const float frame[LIP_FEATURES], size_t head,
                    struct lip_answer *answer);

#endif
