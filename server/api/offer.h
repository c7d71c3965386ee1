/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is on offer, as clients are told of it: languages, engines, expressions, voices. (Heads are files: see
 * assets.h.) Whoever puts the program together fills it in; the network knows no more of any of them. */
#ifndef FACCIA_API_OFFER_H
#define FACCIA_API_OFFER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct offer_language {
    const char *tag, *name;
    const char *const *engines; /* that speak it, NULL-terminated */
};

struct offer_expression {
    const char *kind, *name;
    double activation, evaluation; /* -1..1, place on the emotion disc; of kind "affect" */
    bool basic;
};

struct offer_voice {
    const char *id, *name, *lang, *gender, *quality, *licence, *plugin;
    uint32_t sample_rate, words_per_minute; /* Hz; its own pace */
    bool shares; /* its language has no entry among the languages: its lips are those of all such */
};

/* Read-only. What it points to is good until `now` is asked again. */
struct offer {
    const char *default_lang;
    const char *const *engines; /* NULL-terminated; the first is the default */
    const struct offer_language *languages;
    size_t language_count;
    const struct offer_expression *expressions;
    size_t expression_count;
    const struct offer_voice *voices; /* another list, when they are others */
    size_t voice_count;
};

/* Who knows it. */
struct offer_source {
    const struct offer *(*now)(void *ctx);
    void *ctx;
};

#endif
