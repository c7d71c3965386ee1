/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Identity and rights of a client, from its request's headers or from a token sent later. */
#ifndef FACCIA_API_PRINCIPAL_H
#define FACCIA_API_PRINCIPAL_H

#include "server/access/token.h"

struct connection;
struct exchange;
struct http_request;
struct api;

struct principal {
    struct token token; /* if no tokens are required: subject "", room "", all rights, no expiry */
    char key[80];       /* quota key of its requests: "a ADDRESS" or "s SUBJECT" */
    struct connection *connection;
};

/* Returns whether the page that sent the request may use the daemon. */
bool principal_origin_allowed(const struct api *api, const struct http_request *request);

/* Checks that the Host header is a name of the daemon. -1 with *e: "unknown-host". */
int principal_check_host(const struct api *api, const struct http_request *request, struct error *e);

/* Identifies the client by the token of the request, if there is one (Authorization: Bearer, or token= in
 * the address). -1 with *e: "bad-token", "expired-token", "revoked-token", "too-many-per-address". */
int principal_enter(struct api *api, const struct http_request *request, struct principal *principal,
                    struct error *e);

/* Switches to another token. -1 with *e as above, and the principal is unchanged. */
int principal_show(struct api *api, struct principal *principal, const char *token, struct error *e);

/* Stands for the room that the token is for, or any room. */
extern const char principal_own_room[];

/* Removes the rights if the secret or the token has been revoked. Returns whether it removed any. */
bool principal_revoke(const struct api *api, struct principal *principal);

/* Hash of the quota key, used to schedule quota keys in turn (speech_request.h); never 0. */
uint32_t principal_quota_key(const struct principal *principal);

/* Number of the connection, used to schedule the connections of one quota key in turn; never 0. */
uint32_t principal_connection(const struct principal *principal);

/* Checks a right at the current time. room NULL: no room. -1 with *e: "token-needed", "expired-token",
 * "forbidden". */
int principal_may(const struct api *api, const struct principal *principal, enum right right,
                  const char *room, struct error *e);

/* Counts a request. -1 with *e ("too-many-requests") if the limit for this minute is reached. */
int principal_ask(struct api *api, const struct principal *principal, struct error *e);

/* Checks the page's origin, the right and the request limit. right 0: only the origin. Returns false after
 * answering with an error; the caller then returns *result. */
bool exchange_permits(struct exchange *x, enum right right, const char *room, int *result);
/* Likewise for what anyone may ask, with or without a token: a token that is sent must be valid. */
bool exchange_admits(struct exchange *x, int *result);
struct principal *
exchange_principal(struct exchange *x); /* valid once exchange_permits has granted a right */

#endif
