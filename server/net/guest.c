/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/guest.h"
#include "server/access/origin.h"
#include "server/net/internal.h"
#include <string.h>
#include <time.h>

enum { TOKEN_BYTES = 2048 };

bool guest_origin_allowed(const struct net *net, struct lws *wsi) {
    char origin[256] = "", host[256] = "";
    /* a header that does not fit is from no page that is on the list */
    if (lws_hdr_copy(wsi, origin, sizeof origin, WSI_TOKEN_ORIGIN) < 0 &&
        lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN))
        return false;
    lws_hdr_copy(wsi, host, sizeof host, WSI_TOKEN_HOST);
    return origin_allowed(origin, net->options.secrets ? host : NULL, net->options.origins);
}

/* What follows "token." in the list of sub-protocols: browsers let a page set no other header. libwebsockets
 * refuses a list of more than 126 bytes, so it can only be a short one. */
static void find_in_protocols(struct lws *wsi, char token[TOKEN_BYTES]) {
    static const char prefix[] = "token.";
    char list[128] = "", *rest = NULL;
    lws_hdr_copy(wsi, list, sizeof list, WSI_TOKEN_PROTOCOL);
    for (char *name = strtok_r(list, ", ", &rest); name; name = strtok_r(NULL, ", ", &rest))
        if (!strncmp(name, prefix, strlen(prefix)))
            strcpy(token, name + strlen(prefix));
}

/* The token that stands in the headers, or "". */
static void find_token(struct lws *wsi, char token[TOKEN_BYTES]) {
    static const char scheme[] = "Bearer ";
    char header[TOKEN_BYTES];
    *token = '\0';
    if (lws_hdr_copy(wsi, header, sizeof header, WSI_TOKEN_HTTP_AUTHORIZATION) > 0 &&
        !strncasecmp(header, scheme, strlen(scheme))) {
        strcpy(token, header + strlen(scheme));
        return;
    }
    const char *value = lws_get_urlarg_by_name(wsi, "token=", header, sizeof header);
    if (value)
        strcpy(token, value);
    else
        find_in_protocols(wsi, token);
}

static int enter(struct net *net, struct guest *guest, const char *key, struct error *e) {
    if (!tally_enter(&net->tally, key, net->options.address_connections)) {
        metrics_add(net->studio->metrics, METRIC_REFUSED_LIMIT, 1);
        return error_set(e, "too-many-connections", "too many connections from there are open");
    }
    guest_leave(net, guest);
    snprintf(guest->key, sizeof guest->key, "%s", key);
    guest->entered = true;
    return 0;
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
    if (strcmp(key, guest->key) && enter(net, guest, key, e))
        return -1;
    guest->token = token;
    return 0;
}

int guest_enter(struct net *net, struct lws *wsi, struct guest *guest, struct error *e) {
    char token[TOKEN_BYTES], address[64] = "", key[sizeof guest->key];
    *guest = (struct guest){0};
    if (!net->options.secrets)
        guest->token.rights = RIGHTS_ALL;
    lws_get_peer_simple(wsi, address, sizeof address);
    snprintf(key, sizeof key, "a %s", address);
    if (enter(net, guest, key, e))
        return -1;
    find_token(wsi, token);
    return *token ? guest_show(net, guest, token, e) : 0;
}

void guest_leave(struct net *net, struct guest *guest) {
    if (guest->entered)
        tally_leave(&net->tally, guest->key);
    guest->entered = false;
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
    else if (*token->room && (!room || strcmp(room, token->room)))
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
