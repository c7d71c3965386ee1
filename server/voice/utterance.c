/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/utterance.h"
#include <stdlib.h>

void utterance_free(struct utterance *u) {
    if (!u)
        return;
    for (size_t i = 0; i < u->mark_count; i++)
        free(u->marks[i].name);
    for (size_t i = 0; i < u->warning_count; i++)
        free(u->warnings[i]);
    for (size_t i = 0; i < u->word_count; i++)
        free(u->words[i].text);
    free(u->pcm);
    free(u->phones);
    for (size_t i = 0; i < u->cue_count; i++) {
        free(u->cues[i].kind);
        free(u->cues[i].name);
    }
    free(u->cues);
    free(u->words);
    free(u->marks);
    free(u->warnings);
    free(u);
}
