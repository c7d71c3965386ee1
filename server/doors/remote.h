/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A daemon as programs beside it meet it: by HTTP, like everybody (protocol/README.md, "HTTP"). All calls
 * come back on the loop; nothing blocks. */
#ifndef FACCIA_DOORS_REMOTE_H
#define FACCIA_DOORS_REMOTE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct remote;
struct fetch; /* one request; it ends with its callback, or when it is given up */

/* url: "http://127.0.0.1:8080", without what follows the port; token: NULL = none. NULL after a message when
 * the URL is none. */
struct remote *remote_new(uv_loop_t *loop, const char *url, const char *token);

/* Gives up what is under way: no callback comes after this. The loop has to run until it has nothing to do.
 */
void remote_free(struct remote *remote);

/* What the daemon answered. Pointers are good during the call only. */
struct remote_answer {
    long status;        /* of HTTP; 0: there was no answer */
    bool sent;          /* with status 0: it may have been acted on */
    const json_t *body; /* NULL: no JSON */
    const char *why;    /* for people, when status is 0 or no success */
};

typedef void remote_answered(void *ctx, const struct remote_answer *answer);

/* One member of a query; value NULL: it is left out. */
struct remote_member {
    const char *name, *value;
};

/* POSTs a body to a path such as "/v1/say", with the members, up to one with the name NULL; type: of the
 * content. GETs when body is NULL. */
struct fetch *remote_ask(struct remote *remote, const char *path, const struct remote_member *members,
                         const char *type, const char *body, remote_answered *answered, void *ctx);

/* Gives a room the command that is a message's JSON. */
struct fetch *remote_command(struct remote *remote, const char *room, const char *message,
                             remote_answered *answered, void *ctx);

/* remote_ask, with the bytes of a body of status 200 as they come, if bytes is not NULL: the answer has none
 * of them then. What they do may give up this request, and no other. */
typedef void remote_bytes(void *ctx, const void *bytes, size_t size);
struct fetch *remote_fetch(struct remote *remote, const char *path, const struct remote_member *members,
                           const char *type, const char *body, remote_bytes *bytes, remote_answered *answered,
                           void *ctx);
/* The same for a text that is still being written: remote_write adds to it, remote_close ends it. */
struct fetch *remote_begin(struct remote *remote, const char *path, const struct remote_member *members,
                           const char *type, remote_bytes *bytes, remote_answered *answered, void *ctx);
void remote_write(struct fetch *fetch, const char *text, size_t size);
void remote_close(struct fetch *fetch);

/* No more bytes are wanted for now, but for 1 MB that may have come already; and then again. */
void remote_hold(struct fetch *fetch);
void remote_go_on(struct fetch *fetch);

/* A voice, language or gender that the daemon does not know is left out, which the log tells, and the same is
 * asked again: silence helps nobody who only listens. lang: instead of an unknown voice; NULL: the daemon's
 * own. Call it before anything is written. */
void remote_speak_anyway(struct fetch *fetch, const char *lang);

/* No callback comes after this. */
void remote_give_up(struct fetch *fetch);

/* What they do must not end the following. */
struct remote_events {
    /* A message of the room. */
    void (*event)(void *ctx, const char *type, const json_t *message);
    /* The room is followed from now on; or no longer, and why (NULL: it is). Once it was followed, it is
     * tried again and again. */
    void (*following)(void *ctx, const char *why);
};

struct follow;

/* Looks on in a room. */
struct follow *remote_follow(struct remote *remote, const char *room, const struct remote_events *events,
                             void *ctx);
void remote_unfollow(struct follow *follow);

#endif
