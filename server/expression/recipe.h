/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an entry of the expressions file holds, for what shows it. The file's format is described in
 * models/expressions.md. */
#ifndef FACCIA_EXPRESSION_RECIPE_H
#define FACCIA_EXPRESSION_RECIPE_H

#include "protocol/fap.h"
#include <stdbool.h>
#include <stddef.h>

struct expressions;
struct mood;

enum {
    BASIC_COUNT = 6, /* of FAP 2: 1 joy, 2 sadness, 3 anger, 4 fear, 5 disgust, 6 surprise */
    AFFECTS_MAX = 64,
};

/* Some FAPs with their values in FAP units, rising by number. */
struct pose {
    struct pose_fap {
        int fap;
        double value;
    } * faps;
    size_t count;
};

/* How the intensity goes over the time of the cue: rises in `attack`, stays at 1 for `hold`, settles in
 * `settle` at the level `sustain`, and falls after the end of the cue in `decay`. Seconds, and 0..1. */
struct envelope {
    double attack, hold, settle, sustain, decay;
};

/* Parts of the pose that stay while she speaks, 0..1: of jaw and lips, and of the mouth's corners. */
struct mouth_share {
    double lips, corners;
};

/* How the expressions at a moment change the signs of life; all 1 when neutral. */
struct life_factors {
    double blink_rate, blink_length; /* factors */
    double motion;                   /* factor of head motion */
};

struct voice_factors {
    double rate, pitch, range, volume; /* at intensity 1 */
};

/* A gesture: poses and when they are reached, s from the anchor. The first and the last are at rest. */
enum gesture_anchor { ANCHOR_START, ANCHOR_END };
struct gesture_key {
    double at;
    struct pose pose;
};

struct expression {
    const char *kind; /* static */
    char *name, **aliases;
    double activation, evaluation;
    uint8_t basic;                  /* its number in FAP 2, or 0 */
    double basics[BASIC_COUNT + 1]; /* how much of each basic emotion is in it, 0..1 */
    struct pose pose;               /* that which it is mixed from included */
    struct envelope curve;
    struct mouth_share mouth;
    double articulation; /* factor of the speech's movements */
    struct voice_factors voice;
    struct life_factors life;
    enum gesture_anchor anchor;
    struct gesture_key *keys;
    size_t key_count;
    bool is_sampled; /* keys are frames: straight lines between them */
};

const struct expression *expressions_at(const struct expressions *expressions, size_t index);

/* How much of each affect is in the mood at a time of its clock. Returns how many there are; they are
 * in the order of the file. */
struct mood_part {
    const struct expression *expression;
    double intensity; /* over 0, at most 1 */
};
size_t mood_at(const struct mood *mood, double clock, struct mood_part parts[AFFECTS_MAX]);

#endif
