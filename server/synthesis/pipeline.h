/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all syntheses share, as it is handed from room to room: a stage that only hands it on needs to know
 * none of it.
 */
#ifndef FACCIA_SYNTHESIS_PIPELINE_H
#define FACCIA_SYNTHESIS_PIPELINE_H

#include "server/base/metrics.h"
#include "server/expression/expressions.h"
#include <uv.h>

struct coder_pool;
struct reader;
struct work_gate;
struct codec_load;
struct voice_pool;
struct speech_packs;
struct expressions;
struct face_high_level;
struct normalizers;
struct live_pool;

/* Borrowed. */
struct pipeline {
    uv_loop_t *loop;
    struct voice_pool *voices;
    const struct speech_packs *packs;
    const struct expressions *expressions;    /* others may take their place: who keeps them takes a share */
    const struct face_high_level *high_level; /* NULL = FAP 1 and 2 of recordings move nothing */
    const struct normalizers *normalizers;    /* NULL = say-as is left to the voices */
    const char *default_lang;
    enum face_contacts default_contacts; /* of requests that say "engine" */
    const struct reader *reader;         /* decodes sound that may be damaged (sound_reader.h); NULL = nobody
                                            else does */
    struct work_gate *gate;              /* so many sounds are decoded at a time; NULL = any number */
    const char *sounds;                  /* folder of sound files that texts may name; NULL = none */
    struct metrics *metrics;             /* NULL = nobody counts */
    struct codec_load *codec_load;       /* of the sound; NULL = the best */
    struct coder_pool *coders;           /* that code it; NULL = it is coded on the loop */
    /* Texts of so many bytes and more are read in another thread, so that the loop is free; 0 = none. */
    size_t long_text;
    struct live_pool *live; /* people's own voices; NULL = none can be heard */
    unsigned open_seconds;  /* a text that is being written, and is not for so long, is closed; 0 = never */
};

#endif
