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

/* A handle for an address below the daemon's, with the token. */
CURL *remote_handle(struct remote *remote, struct transfer *transfer, const char *path,
                    const struct remote_member *members);
void remote_start(struct remote *remote, struct transfer *transfer);
/* Frees what remote_handle made. */
void remote_finish(struct remote *remote, struct transfer *transfer);

#endif
