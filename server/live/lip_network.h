/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Classes of sounds that differ on the lips; models/tools/hear/sounds.py maps phones to them. */
#ifndef FACCIA_LIVE_LIP_NETWORK_H
#define FACCIA_LIVE_LIP_NETWORK_H

#include "server/base/error.h"
#include "server/face/packs/shape_table.h"
#include "server/live/lip_features.h"

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
    const char *ipa, *sampa; /* representative phone; "" and "_" for silence */
};

extern const struct lip_class_name lip_classes[LIP_CLASSES];

/* A small recurrent network that predicts mouth movements from features as they arrive: a convolution over
 * recent frames, two layers of gated recurrent units (K. Cho et al., EMNLP 2014), for each lookahead a
 * head for the classes and one for the mouth, and a voice detector. Trained by models/tools/hear; the file
 * is described in models/hear/README.md. */

enum { LIP_HEADS_MOST = 8 };

struct lip_network; /* immutable once loaded, so it can be shared */
struct lip_state;   /* of one recogniser */

/* Returns NULL with *e (bad-network) for an invalid file. */
struct lip_network *lip_network_load(const char *path, struct error *e);
void lip_network_free(struct lip_network *network);

/* Gets the delay of each head in frames, increasing; returns their number. */
size_t lip_network_delays(const struct lip_network *network, unsigned delays[LIP_HEADS_MOST]);

struct lip_state *lip_state_new(const struct lip_network *network);
void lip_state_free(struct lip_state *state);

/* Prediction for the instant one head's delay ago. */
struct lip_answer {
    float likely[LIP_CLASSES]; /* probability of each class; they add up to 1 */
    float mouth[PARAM_COUNT];  /* articulatory parameters, mm */
    float voice;               /* log odds that somebody is speaking now */
};

/* Processes the next frame. */
void lip_state_step(struct lip_state *state, const float frame[LIP_FEATURES], size_t head,
                    struct lip_answer *answer);

#endif
