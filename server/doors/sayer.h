/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Says texts in one room for programs whose users only listen. The daemon accepts a text (202) and may refuse
 * it afterwards, which the room is told: where it does not know the voice or the language, the text is said
 * again without; anything else goes to the log. */
#ifndef FACCIA_DOORS_SAYER_H
#define FACCIA_DOORS_SAYER_H

#include "server/doors/remote.h"

struct sayer;

struct sayer *sayer_new(struct remote *remote, const char *room);
void sayer_free(struct sayer *sayer); /* before the remote; NULL is fine */

/* What is to be said; NULL: left out. */
struct sayer_text {
    const char *type; /* of its content */
    const char *voice, *lang, *markup, *priority;
    const char *other; /* language instead of an unknown voice */
    const char *text;  /* NULL: it is written, with sayer_write to its end, sayer_close */
};

/* The request is the caller's: it ends with its callback, or is given up. */
struct fetch *sayer_say(struct sayer *sayer, const struct sayer_text *text, remote_answered *answered,
                        void *ctx);

/* Of a text that is written: the next piece of it, and its end. */
void sayer_write(struct sayer *sayer, struct fetch *fetch, const char *text, size_t size);
void sayer_close(struct sayer *sayer, struct fetch *fetch);

#endif
