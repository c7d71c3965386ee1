/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A question that is spoken in a channel and waits for its answer: a choice, or the words of a listener. A
 * channel has one at a time. */
#ifndef FACCIA_ROOMS_QUESTION_H
#define FACCIA_ROOMS_QUESTION_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

struct channel;

enum { QUESTION_SECONDS = 60 /* default of its patience */ };

/* Waits for the answer of a question. Whoever creates it owns it. */
struct question_watch {
    struct question *question;                           /* NULL: not waiting */
    void (*answered)(void *ctx, const json_t *answered); /* called once, with the `answered` message */
    void *ctx;
};

/* Begins a question whose text is spoken as `utterance`, and offers the choices of the `ask` message, if it
 * has any. Its patience begins when the text has been spoken. A question that was waiting ends as withdrawn.
 * Returns -1 with *e ("bad-field"), and nothing begins. */
int question_check(const json_t *message, struct error *e);
void question_begin(struct channel *channel, const json_t *message, uint32_t utterance);

/* An utterance is said again under another number: if it is the question, its patience begins anew. */
void question_repeated(struct channel *channel, uint32_t before, uint32_t utterance);

/* Has the watch told the answer of the channel's question. False: there is none. */
bool question_watch_begin(struct question_watch *watch, struct channel *channel);
void question_watch_end(struct question_watch *watch);

/* What happens in the channel. */
void question_spoken(struct channel *channel, uint32_t utterance, const char *reason);
void question_chosen(struct channel *channel, const json_t *chosen);
void question_offered(struct channel *channel); /* other choices, or none, are offered now */
void question_heard(struct channel *channel, const char *text, const char *by);
void question_drop(struct channel *channel); /* the channel is about to be freed */

#endif
