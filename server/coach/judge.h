/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares a recording of a learner with a model, synthetic speech of the same text, phone by phone:
 * goodness of pronunciation (S. M. Witt and S. J. Young, Speech Communication 30, 2000) by the recogniser of
 * models/hear, whose units are classes of sounds that look alike on the lips. It cannot tell the sounds of
 * one class apart (/p b m/). */
#ifndef FACCIA_COACH_JUDGE_H
#define FACCIA_COACH_JUDGE_H

#include "server/base/error.h"
#include "server/library/align/align.h"
#include "server/live/lip_network.h"

enum judge_state {
    JUDGE_UNSURE,    /* neither of the others is certain enough */
    JUDGE_GOOD,      /* the expected class is heard */
    JUDGE_DIFFERENT, /* another class is heard */
    JUDGE_STATES
};

extern const char *const judge_states[JUDGE_STATES]; /* "unsure", "good", "different" */

/* Seconds of the recording. */
struct judged_phone {
    size_t phone, word; /* indices in the model; word SIZE_MAX: of no word */
    double start, end;
    double score;  /* mean log probability of the expected class less that of the likeliest, 0 at most */
    double length; /* duration, relative to the model's at the speaker's pace */
    enum lip_class expected, heard;
    enum judge_state state;
};

struct judged_word {
    double start, end;
    double score;           /* mean of its phones */
    enum judge_state state; /* different if a phone is; good if most are and none is different */
};

struct judgement {
    struct judged_phone *phones;
    size_t phone_count;
    struct judged_word *words; /* one per word of the model */
    size_t word_count;
    double pace;  /* duration of the speech relative to the model's */
    double heard; /* mean log probability of the expected classes, 0 at most */
    bool other;   /* these seem to be other words: all phones are unsure */
};

/* Compares at most some tens of seconds; memory grows with the product of both durations (8 ms frames, a byte
 * each). -1 with *e: "misaligned" if the recording is too short for the text or contains nothing, "cancelled"
 * by *stop. Free the result in either case. */
int judge(const struct align_sound *recording, const struct reference_speech *model,
          const struct lip_network *network, const atomic_bool *stop, struct judgement *result,
          struct error *e);
void judgement_free(struct judgement *judgement);

#endif
