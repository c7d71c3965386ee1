/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The members of a query, or of a JSON body: those that nobody asked for are told of. */
#ifndef FACCIA_NET_QUERY_H
#define FACCIA_NET_QUERY_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

struct http_request;

/* What an address or a body may say. */
struct members {
    bool speech;             /* all that a speech request has, but for its text */
    const char *const *more; /* NULL-terminated, or NULL */
};

/* text: there may be one in the query. Calls warn for each member that there is not ("unknown-member", with
 * its field). */
void query_check(const struct http_request *request, const struct members *known, bool text,
                 void (*warn)(void *ctx, const struct error *e), void *ctx);
void members_check(const json_t *object, const struct members *known,
                   void (*warn)(void *ctx, const struct error *e), void *ctx);

/* A member that says yes or no ("1", "true", "0", "false"); NULL: no. -1 with *e "bad-field". */
int query_flag(const char *value, const char *name, bool *flag, struct error *e);

#endif
