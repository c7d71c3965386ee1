/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What clients can choose from: languages, engines, expressions and voices. (Heads are files: see
 * api_internal.h.) The application fills it in; the network code knows nothing more about them. */
#ifndef FACCIA_API_OFFER_H
#define FACCIA_API_OFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct offer_language {
    const char *tag, *name;
    const char *const *engines; /* engines that speak it, NULL-terminated */
};

struct offer_expression {
    const char *kind, *name;
    double activation, evaluation; /* -1..1, position on the emotion disc; for kind "affect" only */
    bool basic;
};

struct offer_voice {
    const char *id, *name, *lang, *gender, *quality, *licence, *plugin;
    uint32_t sample_rate, words_per_minute; /* Hz; the voice's natural pace */
    bool shares; /* its language is not in `languages`: the lips use the general language pack */
};

/* Read-only. Its pointers are valid until the next call of `now`. */
struct offer {
    const char *default_lang;
    const char *const *engines; /* NULL-terminated; the first is the default */
    const struct offer_language *languages;
    size_t language_count;
    const struct offer_expression *expressions;
    size_t expression_count;
    const struct offer_voice *voices; /* a different pointer whenever the list has changed */
    size_t voice_count;
};

/* Provides the current offer. */
struct offer_source {
    const struct offer *(*now)(void *ctx);
    void *ctx;
};

#endif
