/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speaks texts in one room, for bridges whose users only listen. The daemon may refuse a text after it has
 * accepted it (202); the room's events tell. If the voice or the language is unknown, the text is sent again
 * without it; any other refusal is logged. */
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
