/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Configured voices: programs that read text and write sound (../README.md). */
#ifndef FACCIA_PLUGINS_COMMAND_COMMAND_CONFIG_H
#define FACCIA_PLUGINS_COMMAND_COMMAND_CONFIG_H

#include "server/library/align/times.h"
#include "server/voice/faccia-voice.h"
#include <stdbool.h>

/* Source of the phone times of a program. */
struct cm_timing {
    bool given;
    struct times_options options;
    const json_t *argv; /* a second program that prints them; NULL = in the file {times} */
};

struct cm_voice {
    struct faccia_voice_info info;
    const json_t *argv; /* strings with placeholders; the first is the program */
    bool feed;          /* pass the text on standard input */
    bool file;          /* the sound is in the file {output} instead of standard output */
    uint32_t raw;       /* sample rate of headerless 16-bit mono sound; 0 = a sound file */
    double seconds;     /* limit of a run */
    size_t bytes;       /* limit of its output */
    struct cm_timing timing;
};

struct cm_voices {
    struct cm_voice *list;
    size_t count;
    json_t *root; /* owns their strings */
};

/* config is the plugin's part of the configuration. Returns 1 with a message when it has no voices, -1
 * with a message when it is invalid ("voices[0].argv: ..."). */
int cm_config_read(struct cm_voices *voices, const char *config, char *message, size_t cap);
void cm_config_free(struct cm_voices *voices);
const struct cm_voice *cm_voices_find(const struct cm_voices *voices, const char *id);

#endif
