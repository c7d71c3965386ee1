/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stages up to the network, put together as the settings say: the same for the daemon and for each
 * command of the command line. */
#ifndef FACCIA_APP_STAGES_H
#define FACCIA_APP_STAGES_H

#include "server/app/settings.h"
#include "server/synthesis/live_voice.h"
#include "server/synthesis/synthesis.h"

/* What is wanted of them. */
enum {
    STAGES_SPEECH = 1u << 0,        /* speech packs */
    STAGES_EXPRESSIONS = 1u << 1,   /* with the packs: what FAP 1 and 2 mean, too */
    STAGES_NORMALIZATION = 1u << 2, /* words for digits, dates and sums */
    STAGES_BOUNDARIES = 1u << 3,    /* where voices' phones are heard */
    STAGES_HEARING = 1u << 4,       /* people's own voices, where the models have a network for them */
    STAGES_ALL =
        STAGES_SPEECH | STAGES_EXPRESSIONS | STAGES_NORMALIZATION | STAGES_BOUNDARIES | STAGES_HEARING,
};

struct stages {
    struct speech_packs packs;
    struct face_high_level *high_level;
    struct normalizers normalizers;
    struct boundary_table *boundaries;
    struct live_pool live;
    struct pipeline
        pipeline; /* all of that, and the expressions; what else it has is for the caller to fill in */
};

/* Reads the files. loop NULL: nothing will be spoken. -1 with *e; call stages_free all the same. */
int stages_load(struct stages *stages, const struct settings *settings, unsigned wanted, uv_loop_t *loop,
                struct error *e);

/* Reads the expressions and the gestures again: what is asked for from now on has these. -1 with *e; then it
 * has those of before. */
int stages_load_expressions(struct stages *stages, const struct settings *settings, struct error *e);

/* Starts the voices, which the pipeline has from then on: voices is a copy of the settings' section, with
 * what no setting says but their boundaries. ready as voice_pool_open has it. -1 with *e. */
int stages_start_voices(struct stages *stages, const struct voice_pool_options *voices,
                        void (*ready)(void *ctx), void *ctx, struct error *e);

/* Then the loop must run until it is empty, before stages_free. */
void stages_stop_voices(struct stages *stages);
void stages_free(struct stages *stages);

#endif
