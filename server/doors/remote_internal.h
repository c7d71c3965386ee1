/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of a remote daemon share. */
#ifndef FACCIA_DOORS_REMOTE_INTERNAL_H
#define FACCIA_DOORS_REMOTE_INTERNAL_H

#include "server/base/buf.h"
#include "server/doors/remote.h"
#include <curl/curl.h>

/* One request under way. Its owner embeds it. */
struct transfer {
    CURL *easy;
    struct curl_slist *headers;
    struct transfer *next, **self; /* of the remote's */
    void (*done)(struct transfer *transfer, CURLcode code);
    /* Tells what has come, when curl is not at work: it cannot be asked for anything then. NULL: in the end.
     * It may end its own transfer, and no other. */
    void (*tell)(struct transfer *transfer);
    void (*drop)(struct transfer *transfer); /* the remote is freed: no callback */
};

struct remote {
    uv_loop_t *loop;
    char *url, *token;
    CURLM *multi;
    uv_timer_t *timer;
    struct transfer *transfers;
    struct follow *follows;
    /* Ends all that is followed; NULL: nothing is. */
    void (*drop_follows)(struct remote *remote);
};

/* Appends the daemon's address, without slashes at its end, the path, and those members that have a value; no
 * NUL. */
void remote_address(struct buf *url, const char *daemon, const char *path,
                    const struct remote_member *members);

/* Copies up to one with the name NULL; members NULL: none. Free with remote_free_members. */
struct remote_member *remote_copy_members(const struct remote_member *members);
void remote_free_members(struct remote_member *members);

/* Takes a member's value away. False: it has none. */
bool remote_drop_member(struct remote_member *members, const char *name);

/* Leaves out what the daemon does not know, as the code and the field (NULL: none) of its error say: a voice,
 * a language, a gender. Each time one value goes, so that it ends. instead: the language in place of an
 * unknown voice; NULL: none. False: the error is about none of them. */
bool remote_leave_out(struct remote_member *members, const char *code, const char *field,
                      const char *instead);

/* A handle for an address below the daemon's, with the token. */
CURL *remote_handle(struct remote *remote, struct transfer *transfer, const char *path,
                    const struct remote_member *members);
void remote_start(struct remote *remote, struct transfer *transfer);
/* Frees what remote_handle made. */
void remote_finish(struct remote *remote, struct transfer *transfer);

#endif
