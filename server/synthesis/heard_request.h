/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What somebody asks for who speaks himself: how his voice comes, and how it is to be shown. */
#ifndef FACCIA_SYNTHESIS_HEARD_REQUEST_H
#define FACCIA_SYNTHESIS_HEARD_REQUEST_H

#include "server/synthesis/speech_request.h"

enum {
    HEARD_RATE_LEAST = 8000,
    HEARD_RATE_MOST = 96000,
    HEARD_CHANNELS_MOST = 8,
    HEARD_LOOKAHEAD = 80, /* ms, unless another is asked for */
};

enum heard_codec { HEARD_PCM, HEARD_OPUS };

/* "pcm_s16le" and "opus", NULL-terminated, in the order of their enum. */
extern const char *const heard_codecs[];

struct heard_request {
    const struct speech_request *speech; /* what is no matter of its text */
    enum heard_codec codec;
    unsigned rate, channels, lookahead; /* Hz; ms */
};

/* -1 with *e ("unknown-codec", field "codec"). "pcm" will do, too. */
int heard_codec_find(const char *name, enum heard_codec *codec, struct error *e);

/* Whether sound comes like that: -1 with *e ("bad-field"). */
int heard_request_check(const struct heard_request *request, struct error *e);

#endif
