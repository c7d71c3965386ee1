/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP client of a daemon for the bridges (protocol/README.md, "HTTP"). Callbacks run on the loop; nothing
 * blocks. */
#ifndef FACCIA_BRIDGES_REMOTE_H
#define FACCIA_BRIDGES_REMOTE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct remote;
struct fetch; /* a request, until its callback or its cancellation */

/* url: "http://127.0.0.1:8080", without a path; token: NULL = none. NULL after a message for an invalid
 * URL. */
struct remote *remote_new(uv_loop_t *loop, const char *url, const char *token);

/* Cancels all requests; no callback follows. Run the loop until it is empty. */
void remote_free(struct remote *remote);

/* Answer of the daemon. Pointers are valid during the callback only. */
struct remote_answer {
    long status;        /* HTTP status; 0: no answer */
    bool sent;          /* with status 0: the daemon may have acted on the request */
    const json_t *body; /* NULL: not JSON */
    const char *why;    /* message, if status is 0 or no success */
};

typedef void remote_answered(void *ctx, const struct remote_answer *answer);

/* Member of a query; value NULL: omitted. */
struct remote_member {
    const char *name, *value;
};

/* POSTs a body to a path such as "/v1/say" with a query of members, up to one with name NULL; type: of the
 * content. body NULL: GET. */
struct fetch *remote_ask(struct remote *remote, const char *path, const struct remote_member *members,
                         const char *type, const char *body, remote_answered *answered, void *ctx);

/* Gives a room a command: the JSON of a message. */
struct fetch *remote_command(struct remote *remote, const char *room, const char *message,
                             remote_answered *answered, void *ctx);

/* The same, passing the bytes of a 200 answer to `bytes` (unless NULL) as they arrive; the answer has no
 * body then. The callback may cancel this request, and no other. */
typedef void remote_bytes(void *ctx, const void *bytes, size_t size);
struct fetch *remote_fetch(struct remote *remote, const char *path, const struct remote_member *members,
                           const char *type, const char *body, remote_bytes *bytes, remote_answered *answered,
                           void *ctx);
/* The same for a text in progress: remote_write adds to it, remote_close ends it. */
struct fetch *remote_begin(struct remote *remote, const char *path, const struct remote_member *members,
                           const char *type, remote_bytes *bytes, remote_answered *answered, void *ctx);
void remote_write(struct fetch *fetch, const char *text, size_t size);
void remote_close(struct fetch *fetch);

/* Pauses the bytes, except for up to 1 MB already received; and resumes. */
void remote_hold(struct fetch *fetch);
void remote_go_on(struct fetch *fetch);

/* Leaves out a voice, language or gender that the daemon does not know, logs it and retries, as silence
 * does not help a listener. lang: replaces an unknown voice; NULL: the daemon's default. Call it before
 * writing. */
void remote_speak_anyway(struct fetch *fetch, const char *lang);

/* Cancels the request; no callback follows. */
void remote_give_up(struct fetch *fetch);

/* Callbacks; they must not stop following. */
struct remote_events {
    /* A message of the room. */
    void (*event)(void *ctx, const char *type, const json_t *message);
    /* The room is followed (why NULL), or the connection failed (why). Once it has worked, it is retried
     * indefinitely. */
    void (*following)(void *ctx, const char *why);
};

struct follow;

/* Follows a room. */
struct follow *remote_follow(struct remote *remote, const char *room, const struct remote_events *events,
                             void *ctx);
void remote_unfollow(struct follow *follow);

#endif
