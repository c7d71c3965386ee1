/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Speaks texts in one room, for bridges whose users only listen. The daemon may refuse a text after it has
 * accepted it (202); the room's events tell. If the voice or the language is unknown, the text is sent again
 * without it; any other refusal is logged. */
#ifndef FACCIA_BRIDGES_SPEECH_CLIENT_H
#define FACCIA_BRIDGES_SPEECH_CLIENT_H

#include "server/bridges/remote.h"

struct speech_client;

struct speech_client *speech_client_new(struct remote *remote, const char *room);
void speech_client_free(struct speech_client *client); /* call it before remote_free; NULL is ignored */

/* NULL members are omitted. */
struct speech_text {
    const char *type; /* content type */
    const char *voice, *lang, *markup, *priority;
    const char *other; /* language in place of an unknown voice */
    const char *text;  /* NULL: written with speech_client_write, ended by speech_client_close */
};

/* The caller owns the request until its callback or cancellation. */
struct fetch *speech_client_say(struct speech_client *client, const struct speech_text *text,
                                remote_answered *answered, void *ctx);

/* Adds a piece to a text in progress, and ends it. */
void speech_client_write(struct speech_client *client, struct fetch *fetch, const char *text, size_t size);
void speech_client_close(struct speech_client *client, struct fetch *fetch);

#endif
