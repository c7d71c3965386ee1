/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Components shared by all syntheses. A separate header, so that code can pass the pipeline on without
 * including the components' headers. */
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
struct lexicons;
struct library;
struct live_pool;
struct ear_pool;
struct lip_network;

/* All borrowed. */
struct pipeline {
    uv_loop_t *loop;
    struct voice_pool *voices;
    const struct speech_packs *packs;
    const struct expressions *expressions;    /* may be replaced by a reload: holders take a reference */
    const struct face_high_level *high_level; /* NULL = ignore FAP 1 and 2 of recordings */
    const struct normalizers *normalizers;    /* NULL = leave say-as to the voices */
    const struct lexicons *lexicons;          /* for all texts; NULL = none */
    const struct lexicons *named_lexicons;    /* for texts that name them; NULL = none */
    /* Adds the lexicons of a passage's work and of its library; NULL = there is no library. */
    void (*passage_lexicons)(struct library *library, const char *passage, struct lexicons *to);
    struct library *library; /* its first argument */
    const char *default_lang;
    enum face_contacts default_contacts; /* for requests with contacts "engine" */
    const struct reader *reader;         /* decodes untrusted sound (sound_reader.h); NULL = none */
    struct work_gate *gate;              /* limits concurrent decoding; NULL = no limit */
    const char *sounds;                  /* folder of sound files for texts; NULL = none */
    struct metrics *metrics;             /* NULL = no metrics */
    struct codec_load *codec_load;       /* load of the sound coders; NULL = best quality */
    struct coder_pool *coders;           /* coding threads; NULL = code on the loop */
    /* Texts of at least this many bytes are parsed on another thread; 0 = never. */
    size_t long_text;
    struct live_pool *live;            /* live voices; NULL = disabled */
    const struct lip_network *hearing; /* recogniser of visible sounds; NULL = none */
    struct ear_pool *ears;             /* recognition of listeners; NULL = disabled */
    unsigned open_seconds;             /* an open text is closed after this many idle seconds; 0 = never */
};

#endif
