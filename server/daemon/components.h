/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The components up to the network, assembled from the settings: shared by the daemon and the commands. */
#ifndef FACCIA_DAEMON_COMPONENTS_H
#define FACCIA_DAEMON_COMPONENTS_H

#include "server/daemon/settings.h"
#include "server/live/ear.h"
#include "server/live/live_voice.h"
#include "server/normalize/lexicon.h"
#include "server/synthesis/synthesis.h"

/* Selects the parts to load. */
enum {
    COMPONENTS_SPEECH = 1u << 0,        /* speech packs */
    COMPONENTS_EXPRESSIONS = 1u << 1,   /* including the meaning of FAP 1 and 2; needs the packs */
    COMPONENTS_NORMALIZATION = 1u << 2, /* words for numbers, dates and amounts; lexicons */
    COMPONENTS_BOUNDARIES = 1u << 3,    /* corrections of phone boundaries, by voice */
    COMPONENTS_HEARING = 1u << 4,       /* lips for live voices, if the models include a network for them */
    COMPONENTS_ALL = COMPONENTS_SPEECH | COMPONENTS_EXPRESSIONS | COMPONENTS_NORMALIZATION |
                     COMPONENTS_BOUNDARIES | COMPONENTS_HEARING,
};

struct components {
    struct speech_packs packs;
    struct face_high_level *high_level;
    struct normalizers normalizers;
    struct lexicons lexicons, named_lexicons;
    struct boundary_table *boundaries;
    struct live_pool live;
    struct ear_pool ears;
    struct pipeline pipeline; /* all of the above and the expressions; the caller fills in the rest */
};

/* Reads the files. loop NULL: nothing will be spoken. -1 with *e; call components_free in either case. */
int components_load(struct components *components, const struct settings *settings, unsigned wanted,
                    uv_loop_t *loop, struct error *e);

/* Reloads expressions and gestures for later requests. -1 with *e; then the old ones stay. */
int components_load_expressions(struct components *components, const struct settings *settings,
                                struct error *e);

/* Starts the voices and adds them to the pipeline. `voices` is a copy of the settings, completed by members
 * that are not settings, except the boundaries. For ready see voice_pool_open. -1 with *e. */
int components_start_voices(struct components *components, const struct voice_pool_options *voices,
                            void (*ready)(void *ctx), void *ctx, struct error *e);

/* After this, run the loop until it is empty, then call components_free. */
void components_stop_voices(struct components *components);
void components_free(struct components *components);

#endif
