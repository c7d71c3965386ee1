/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether anybody speaks, or it is music or noise: evidence adds up, so that a doubtful moment changes
 * nothing. In silence it stays as it is. */
#ifndef FACCIA_HEAR_HEAR_VOICE_H
#define FACCIA_HEAR_HEAR_VOICE_H

#include <stdbool.h>

struct hear_voice {
    float evidence;
    bool none; /* nobody speaks */
};

void hear_voice_begin(struct hear_voice *voice);

/* Takes the next frame: how likely a voice is (the logarithm of the odds), and how likely silence. */
void hear_voice_step(struct hear_voice *voice, float odds, float silence);

#endif
