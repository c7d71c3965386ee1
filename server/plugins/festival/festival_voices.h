/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plugin's voices, from festival.json, where new voices and languages can be added. */
#ifndef FACCIA_PLUGINS_FESTIVAL_FESTIVAL_VOICES_H
#define FACCIA_PLUGINS_FESTIVAL_FESTIVAL_VOICES_H

#include "server/voice/faccia-voice.h"
#include <jansson.h>
#include <stdbool.h>

enum { FE_VOICES_MAX = 64 };

/* Spelling rules and phones of a language. */
struct fe_language {
    const char *letters;     /* non-ASCII letters that its rules read, UTF-8; all in ISO-8859-1 */
    const char *punctuation; /* ASCII punctuation that Festival strips from a word's end */
    const json_t *symbols;   /* character -> words */
    const json_t *phones;    /* Festival's name -> IPA, "" = a pause */
};

struct fe_voice {
    struct faccia_voice_info info;
    const char *festival; /* its name: "lp_diphone" */
    bool hts;             /* accepts a rate per utterance, and no pitch */
    double units;         /* factor on diphones before joining, to avoid overflow */
    double gain;          /* factor on the audio afterwards */
    struct fe_language language;
};

struct fe_voices {
    struct fe_voice list[FE_VOICES_MAX]; /* installed ones */
    size_t count;
    json_t *root; /* owns the JSON strings */
};

#endif
