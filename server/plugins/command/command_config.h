/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voices that the configuration describes: programs that read text and write sound (../README.md). */
#ifndef FACCIA_PLUGINS_COMMAND_COMMAND_CONFIG_H
#define FACCIA_PLUGINS_COMMAND_COMMAND_CONFIG_H

#include "server/align/times.h"
#include "server/voice/faccia-voice.h"
#include <stdbool.h>

/* How a program tells its times. */
struct cm_timing {
    bool given;
    struct times_options options;
    const json_t
        *argv; /* a second program that writes them to its standard output; NULL = in the file {times} */
};

struct cm_voice {
    struct faccia_voice_info info;
    const json_t *argv; /* texts, with placeholders; the first is the program */
    bool feed;          /* the text goes to its standard input */
    bool file;          /* the sound comes in the file {output}, not on standard output */
    uint32_t raw;       /* sample rate of sound without a header, 16 bit mono; 0 = a sound file */
    double seconds;     /* that one run may take */
    size_t bytes;       /* that it may write */
    struct cm_timing timing;
};

struct cm_voices {
    struct cm_voice *list;
    size_t count;
    json_t *root; /* owns their strings */
};

/* config is the plugin's part of the configuration. With a sentence in message: 1 when it has no voices, -1
 * when something in it is wrong ("voices[0].argv: ..."). */
int cm_config_read(struct cm_voices *voices, const char *config, char *message, size_t cap);
void cm_config_free(struct cm_voices *voices);
const struct cm_voice *cm_voices_find(const struct cm_voices *voices, const char *id);

#endif
