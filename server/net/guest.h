/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who somebody is and what he may do: from the headers of his request, or from a token that he sends later.
 */
#ifndef FACCIA_NET_GUEST_H
#define FACCIA_NET_GUEST_H

#include "server/access/token.h"

struct connection;
struct http_request;
struct net;

struct guest {
    struct token token; /* subject "", room "", all rights and no end where no tokens are demanded */
    char key[80];       /* what his requests are counted by: "a ADDRESS" or "s SUBJECT" */
    struct connection *connection;
};

/* The page that the request comes from may use the daemon. */
bool guest_origin_allowed(const struct net *net, const struct http_request *request);

/* It asks by a name of the daemon's own. -1 with *e: "unknown-host". */
int guest_check_host(const struct net *net, const struct http_request *request, struct error *e);

/* Lets him in, with the token of his headers (Authorization: Bearer, or token= in the address) if there is
 * one. -1 with *e: "bad-token", "expired-token", "too-many-connections". */
int guest_enter(struct net *net, const struct http_request *request, struct guest *guest, struct error *e);

/* Another token. -1 with *e as above; then the guest is as he was. */
int guest_show(struct net *net, struct guest *guest, const char *token, struct error *e);

/* Stands for the room that the token is for, or any. */
extern const char guest_own_room[];

/* His secret is gone: then so are his rights. True: he had some. */
bool guest_revoke(const struct net *net, struct guest *guest);

/* May he do that now? room NULL = no room. -1 with *e: "token-needed", "expired-token", "forbidden". */
int guest_may(const struct net *net, const struct guest *guest, enum right right, const char *room,
              struct error *e);

/* One more request of his. -1 with *e ("too-many-requests") when there have been too many in this minute. */
int guest_ask(struct net *net, const struct guest *guest, struct error *e);

#endif
