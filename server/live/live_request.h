/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A request for a live voice: the sound's format and how it is shown. */
#ifndef FACCIA_LIVE_LIVE_REQUEST_H
#define FACCIA_LIVE_LIVE_REQUEST_H

#include "server/synthesis/speech_request.h"

enum {
    LIVE_RATE_MIN = 8000,
    LIVE_RATE_MAX = 96000,
    LIVE_CHANNELS_MAX = 8,
    LIVE_LOOKAHEAD = 80, /* default, ms */
};

enum live_codec { LIVE_PCM, LIVE_OPUS };

/* "pcm_s16le" and "opus", in the order of the enum, NULL-terminated. */
extern const char *const live_codecs[];

struct live_request {
    const struct speech_request *speech; /* its fields other than those of a text */
    enum live_codec codec;
    unsigned rate, channels, lookahead; /* Hz; ms */
};

/* Returns -1 with *e ("unknown-codec", field "codec"). Accepts "pcm" too. */
int live_codec_find(const char *name, enum live_codec *codec, struct error *e);

/* Checks the sound format. Returns -1 with *e ("bad-field"). */
int live_request_check(const struct live_request *request, struct error *e);

#endif
