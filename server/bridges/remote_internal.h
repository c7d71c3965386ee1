/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private parts of the HTTP client, for the bridge programs. */
#ifndef FACCIA_BRIDGES_REMOTE_INTERNAL_H
#define FACCIA_BRIDGES_REMOTE_INTERNAL_H

#include "server/base/buf.h"
#include "server/bridges/remote.h"
#include <curl/curl.h>

/* A transfer in progress, embedded by its owner. */
struct transfer {
    CURL *easy;
    struct curl_slist *headers;
    struct transfer *next, **self; /* in the remote's list */
    void (*done)(struct transfer *transfer, CURLcode code);
    /* Delivers received data outside curl's callbacks, where requests are not allowed. NULL: deliver at
     * the end. May end its own transfer, and no other. */
    void (*tell)(struct transfer *transfer);
    void (*drop)(struct transfer *transfer); /* the remote is being freed: no callback */
};

struct remote {
    uv_loop_t *loop;
    char *url, *token;
    CURLM *multi;
    uv_timer_t *timer;
    struct transfer *transfers;
    struct follow *follows;
    /* Stops following; NULL: nothing is followed. */
    void (*drop_follows)(struct remote *remote);
};

/* Appends the daemon's address without trailing slashes, the path, and the members that have a value; no
 * NUL. */
void remote_address(struct buf *url, const char *daemon, const char *path,
                    const struct remote_member *members);

/* Copies up to the member with name NULL; NULL: none. Free with remote_free_members. */
struct remote_member *remote_copy_members(const struct remote_member *members);
void remote_free_members(struct remote_member *members);

/* Removes a member's value. False: it has none. */
bool remote_drop_member(struct remote_member *members, const char *name);

/* Removes the member that the daemon does not know, according to the code and field (NULL: none) of its
 * error: a voice, a language or a gender. Each call removes one, so retries end. instead: language in
 * place of an unknown voice; NULL: none. False: another error. */
bool remote_leave_out(struct remote_member *members, const char *code, const char *field,
                      const char *instead);

/* Makes a handle for an address of the daemon, with the token. */
CURL *remote_handle(struct remote *remote, struct transfer *transfer, const char *path,
                    const struct remote_member *members);

#endif
