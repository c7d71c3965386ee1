/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/guest.h"
#include "server/access/host.h"
#include "server/access/origin.h"
#include "server/net/connection.h"
#include "server/net/internal.h"
#include <string.h>
#include <strings.h>
#include <time.h>
#include <unistd.h>

enum { TOKEN_BYTES = 4096 };

const char guest_own_room[] = "";

int guest_check_host(const struct net *net, const struct http_request *request, struct error *e) {
    char own[256] = "";
    const char *host = http_header(request, "host");
    gethostname(own, sizeof own - 1);
    if (host_allowed(host, own, net->options.host_names) || host_allowed(host, net->options.host, NULL))
        return 0;
    metrics_add(net->studio->metrics, METRIC_REFUSED_ORIGIN, 1);
    return error_set(
        e, "unknown-host",
        "this server has no name '%.100s'; when it shall have that name, start it with --host-name", host);
}

bool guest_revoke(const struct net *net, struct guest *guest) {
    bool lost = guest->token.rights && net->options.secrets &&
                !secrets_have(net->options.secrets, guest->token.secret);
    if (lost)
        guest->token = (struct token){0};
    return lost;
}

/* A browser that fetches for a page of another site says whose it is, or that it does. */
static bool is_unsaid_allowed(const struct http_request *request) {
    return origin_unsaid_allowed(http_header(request, "sec-fetch-site"),
                                 http_header(request, "sec-fetch-mode"),
                                 http_header(request, "sec-fetch-user"));
}

bool guest_origin_allowed(const struct net *net, const struct http_request *request) {
    const char *origin = http_header(request, "origin"), *host = http_header(request, "host");
    if (!origin && !is_unsaid_allowed(request))
        return false;
    return origin_allowed(origin ? origin : "", net->options.secrets && host ? host : NULL,
                          net->options.origins);
}

/* What follows "token." in the list of sub-protocols: browsers let a page set no other header. */
static void find_in_protocols(const struct http_request *request, char token[TOKEN_BYTES]) {
    static const char prefix[] = "token.";
    const char *word;
    size_t at = 0, length;
    while (http_header_next(request, "sec-websocket-protocol", &at, &word, &length))
        if (length > strlen(prefix) && !strncmp(word, prefix, strlen(prefix)))
            snprintf(token, TOKEN_BYTES, "%.*s", (int)(length - strlen(prefix)), word + strlen(prefix));
}

/* The token that stands in the headers, or "". One that is cut is nobody's. */
static void find_token(const struct http_request *request, char token[TOKEN_BYTES]) {
    static const char scheme[] = "Bearer ";
    const char *header = http_header(request, "authorization"), *value = http_query(request, "token");
    *token = '\0';
    if (header && !strncasecmp(header, scheme, strlen(scheme)))
        snprintf(token, TOKEN_BYTES, "%s", header + strlen(scheme));
    else if (value)
        snprintf(token, TOKEN_BYTES, "%s", value);
    else
        find_in_protocols(request, token);
}

int guest_show(struct net *net, struct guest *guest, const char *text, struct error *e) {
    struct token token;
    char key[sizeof guest->key];
    if (!net->options.secrets)
        return 0;
    if (token_check(net->options.secrets, text, (long)time(NULL), &token, e)) {
        metrics_add(net->studio->metrics, METRIC_REFUSED_TOKEN, 1);
        return -1;
    }
    snprintf(key, sizeof key, "s %s", token.subject);
    if (!connection_count(guest->connection, key)) {
        metrics_add(net->studio->metrics, METRIC_REFUSED_LIMIT, 1);
        return error_set(e, "too-many-connections", "too many connections from there are open");
    }
    memcpy(guest->key, key, sizeof guest->key);
    guest->token = token;
    return 0;
}

int guest_enter(struct net *net, const struct http_request *request, struct guest *guest, struct error *e) {
    char token[TOKEN_BYTES];
    *guest = (struct guest){.connection = request->connection};
    if (!net->options.secrets)
        guest->token.rights = RIGHTS_ALL;
    snprintf(guest->key, sizeof guest->key, "%s", request->connection->address_key);
    find_token(request, token);
    return *token ? guest_show(net, guest, token, e) : 0;
}

int guest_may(const struct net *net, const struct guest *guest, enum right right, const char *room,
              struct error *e) {
    const struct token *token = &guest->token;
    if (!net->options.secrets)
        return 0;
    int refused = 0;
    if (!token->rights)
        refused = error_set(e, "token-needed", "this server wants a token");
    else if (token->expires <= (long)time(NULL))
        refused = error_set(e, "expired-token", "the token has expired");
    else if (!(token->rights & right))
        refused = error_set(e, "forbidden", "the token does not give the right to do that");
    else if (*token->room && room != guest_own_room && (!room || strcmp(room, token->room)))
        refused = error_set(e, "forbidden", "the token is for the room '%s'", token->room);
    if (refused)
        metrics_add(net->studio->metrics, METRIC_REFUSED_TOKEN, 1);
    return refused;
}

int guest_ask(struct net *net, const struct guest *guest, struct error *e) {
    uint64_t now = uv_now(net->studio->loop);
    if (tally_ask(&net->tally, guest->key, net->options.address_requests, now))
        return 0;
    metrics_add(net->studio->metrics, METRIC_REFUSED_LIMIT, 1);
    return error_set(e, "too-many-requests", "%u requests in a minute are the limit",
                     net->options.address_requests);
}
