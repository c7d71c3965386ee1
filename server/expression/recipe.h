/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contents of an entry of the expressions file, for rendering. The format is described in
 * models/expressions.md. */
#ifndef FACCIA_EXPRESSION_RECIPE_H
#define FACCIA_EXPRESSION_RECIPE_H

#include "protocol/fap.h"
#include "server/markup/score.h"
#include <stdbool.h>
#include <stddef.h>

struct expressions;
struct mood;

enum {
    BASIC_COUNT = 6, /* of FAP 2: 1 joy, 2 sadness, 3 anger, 4 fear, 5 disgust, 6 surprise */
    AFFECTS_MAX = 64,
};

/* FAP values in FAP units, sorted by number. */
struct pose {
    struct pose_fap {
        int fap;
        double value;
    } * faps;
    size_t count;
};

/* Intensity over a cue's time: rises during `attack`, holds 1 for `hold`, falls in `settle` to `sustain`,
 * and after the cue to 0 in `decay`. Seconds, and 0..1. */
struct envelope {
    double attack, hold, settle, sustain, decay;
};

/* Share of the pose kept during speech, 0..1: for jaw and lips, and for the corners of the mouth. */
struct mouth_share {
    double lips, corners;
};

/* Effect of expressions on idle motion; all 1 when neutral. */
struct life_factors {
    double blink_rate, blink_length; /* factors */
    double motion;                   /* factor of head motion */
};

struct voice_factors {
    double rate, pitch, range, volume; /* at intensity 1 */
    struct score_quality quality;      /* added, at intensity 1 */
};

/* A gesture: poses with their times, s from the anchor. The first and last are neutral. */
enum gesture_anchor { ANCHOR_START, ANCHOR_END };
struct gesture_key {
    double at;
    struct pose pose;
};

struct expression {
    const char *kind; /* static string */
    char *name, **aliases;
    double activation, evaluation;
    uint8_t basic;                  /* its number in FAP 2, or 0 */
    double basics[BASIC_COUNT + 1]; /* share of each basic emotion, 0..1 */
    struct pose pose;               /* including its mixture */
    struct envelope curve;
    struct mouth_share mouth;
    double articulation; /* factor of speech movements */
    struct voice_factors voice;
    struct life_factors life;
    enum gesture_anchor anchor;
    struct gesture_key *keys;
    size_t key_count;
    bool is_sampled; /* keys are frames, interpolated linearly */
};

const struct expression *expressions_at(const struct expressions *expressions, size_t index);

/* Gets the share of each affect in the mood at a time of its clock, in file order. Returns their number. */
struct mood_part {
    const struct expression *expression;
    double intensity; /* above 0, at most 1 */
};
size_t mood_at(const struct mood *mood, double clock, struct mood_part parts[AFFECTS_MAX]);

#endif
