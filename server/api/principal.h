/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who somebody is and what he may do: from the headers of his request, or from a token that he sends later.
 */
#ifndef FACCIA_API_PRINCIPAL_H
#define FACCIA_API_PRINCIPAL_H

#include "server/access/token.h"

struct connection;
struct exchange;
struct http_request;
struct api;

struct principal {
    struct token token; /* subject "", room "", all rights and no end where no tokens are demanded */
    char key[80];       /* what his requests are counted by: "a ADDRESS" or "s SUBJECT" */
    struct connection *connection;
};

/* The page that the request comes from may use the daemon. */
bool principal_origin_allowed(const struct api *api, const struct http_request *request);

/* It asks by a name of the daemon's own. -1 with *e: "unknown-host". */
int principal_check_host(const struct api *api, const struct http_request *request, struct error *e);

/* Lets him in, with the token of his headers (Authorization: Bearer, or token= in the address) if there is
 * one. -1 with *e: "bad-token", "expired-token", "revoked-token", "too-many-per-address". */
int principal_enter(struct api *api, const struct http_request *request, struct principal *principal,
                    struct error *e);

/* Another token. -1 with *e as above; then the principal is as he was. */
int principal_show(struct api *api, struct principal *principal, const char *token, struct error *e);

/* Stands for the room that the token is for, or any. */
extern const char principal_own_room[];

/* His secret or token counts no more: then so are his rights. True: he had some. */
bool principal_revoke(const struct api *api, struct principal *principal);

/* Him as a number, for those who are to come by turns (speech_request.h); never 0. */
uint32_t principal_payer(const struct principal *principal);

/* His connection as a number, for those of one payer to come by turns; never 0. */
uint32_t principal_asker(const struct principal *principal);

/* May he do that now? room NULL = no room. -1 with *e: "token-needed", "expired-token", "forbidden". */
int principal_may(const struct api *api, const struct principal *principal, enum right right,
                  const char *room, struct error *e);

/* One more request of his. -1 with *e ("too-many-requests") when there have been too many in this minute. */
int principal_ask(struct api *api, const struct principal *principal, struct error *e);

/* Whether the client of the request may do that; when not, it has been answered and *result is what to
 * return. right 0: any may whose page is allowed. */
bool exchange_permits(struct exchange *x, enum right right, const char *room, int *result);
struct principal *
exchange_principal(struct exchange *x); /* once it has been permitted something that needs a right */

#endif
