/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voices that the plugin knows, from festival.json: a new voice or language is an entry there. */
#ifndef FACCIA_PLUGINS_FESTIVAL_FESTIVAL_VOICES_H
#define FACCIA_PLUGINS_FESTIVAL_FESTIVAL_VOICES_H

#include "server/voice/faccia-voice.h"
#include <jansson.h>
#include <stdbool.h>

enum { FE_VOICES_MAX = 64 };

/* How a language is written for Festival, and what its phones are. */
struct fe_language {
    const char *letters;     /* the letters beyond ASCII that its rules read, UTF-8; all are in ISO-8859-1 */
    const char *punctuation; /* ASCII that Festival takes off a word's end */
    const json_t *symbols;   /* character -> words */
    const json_t *phones;    /* Festival's name -> IPA, "" = a pause */
};

struct fe_voice {
    struct faccia_voice_info info;
    const char *festival; /* its name: "lp_diphone" */
    bool hts;             /* it takes a rate for a whole sentence, and no pitch */
    double units; /* what diphones are multiplied by before they are joined, so that no sum overflows */
    double gain;  /* what the audio is multiplied by afterwards */
    struct fe_language language;
};

struct fe_voices {
    struct fe_voice list[FE_VOICES_MAX]; /* those that are installed */
    size_t count;
    json_t *root; /* owns all of it */
};

#endif
