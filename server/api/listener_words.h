/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words of a listener, wherever they were recognised: tells those who may know them, and acts on them. */
#ifndef FACCIA_API_LISTENER_WORDS_H
#define FACCIA_API_LISTENER_WORDS_H

#include <jansson.h>
#include <stdbool.h>

struct api;
struct channel;

struct listener_words {
    const char *id, *text;
    const char *lang; /* NULL: the daemon's */
    const char *by;
    bool final;
    double confidence; /* negative: not known */
};

/* The `heard` message; the caller releases it. */
json_t *listener_words_message(const struct channel *channel, const struct listener_words *words);

/* Tells the room's observers who may know them. */
void listener_words_tell(struct channel *channel, const struct listener_words *words);

/* Final words may choose one of the answers on offer, have the last utterance said again, or answer a
 * question. */
void listener_words_act(const struct api *api, struct channel *channel, const struct listener_words *words);

#endif
