/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/access/origin.h"
#include "server/api/api_internal.h"
#include "server/api/shared_limits.h"
#include "server/base/mem.h"
#include <string.h>
#include <strings.h>
#include <time.h>
#include <unistd.h>

enum { TOKEN_BYTES = 4096 };

const char principal_own_room[] = "";

int principal_check_host(const struct api *api, const struct http_request *request, struct error *e) {
    char own[256] = "";
    const char *host = http_header(request, "host");
    gethostname(own, sizeof own - 1);
    if (host_allowed(host, own, api->options.host_names, http_server_is_local(api->http)) ||
        host_allowed(host, api->options.http.host, NULL, http_server_is_local(api->http)))
        return 0;
    metrics_add(api->pipeline->metrics, METRIC_REFUSED_ORIGIN, 1);
    return error_set(e, ERROR_UNKNOWN_HOST,
                     "this server is not named '%.100s'; to add the name, start it with --host-name", host);
}

bool principal_revoke(const struct api *api, struct principal *principal) {
    bool lost = principal->token.rights && api->options.secrets &&
                (!secrets_have(&api->secrets, principal->token.secret) ||
                 revocations_have(&api->revocations, &principal->token));
    if (lost)
        principal->token = (struct token){0};
    return lost;
}

/* Returns whether a browser sent a GET that makes the daemon speak. PowerShell also calls itself Mozilla. */
static bool is_browser_speaking(const struct http_request *request) {
    const char *agent = http_header(request, "user-agent");
    return request->method == HTTP_GET && !strcmp(request->path, "/v1/speech") && agent &&
           !strncmp(agent, "Mozilla/", 8) && !strstr(agent, "PowerShell");
}

/* A browser that fetches for another site's page sends the origin or Sec-Fetch-Site. One that sends
 * neither is old or considers the address insecure (HTTP by a name other than localhost). Then any page
 * could have caused a GET, and only a token proves the right to speak. With other methods browsers always
 * send the origin. */
static bool is_unsaid_allowed(const struct api *api, const struct http_request *request) {
    const char *site = http_header(request, "sec-fetch-site");
    if (!site && !api->options.secrets && is_browser_speaking(request))
        return false;
    return origin_unsaid_allowed(site, http_header(request, "sec-fetch-mode"),
                                 http_header(request, "sec-fetch-user"),
                                 http_header(request, "sec-fetch-dest"));
}

bool principal_origin_allowed(const struct api *api, const struct http_request *request) {
    const char *origin = http_header(request, "origin"), *host = http_header(request, "host");
    if (!origin && !is_unsaid_allowed(api, request))
        return false;
    return origin_allowed(origin ? origin : "", api->options.secrets && host ? host : NULL,
                          api->options.origins);
}

/* Finds the word "token.TOKEN" in the list of sub-protocols: browsers let a page set no other header. */
static void find_in_protocols(const struct http_request *request, char token[TOKEN_BYTES]) {
    static const char prefix[] = "token.";
    const char *word;
    size_t at = 0, length;
    while (http_header_next(request, "sec-websocket-protocol", &at, &word, &length))
        if (length > strlen(prefix) && !strncmp(word, prefix, strlen(prefix)))
            snprintf(token, TOKEN_BYTES, "%.*s", (int)(length - strlen(prefix)), word + strlen(prefix));
}

/* Copies the token of the request, or "". A token that is too long is truncated, and so invalid. */
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

static int check_revoked(const struct api *api, const struct token *token, struct error *e) {
    return revocations_have(&api->revocations, token) ? error_plain(e, ERROR_REVOKED_TOKEN) : 0;
}

int principal_show(struct api *api, struct principal *principal, const char *text, struct error *e) {
    struct token token;
    char key[sizeof principal->key];
    if (!api->options.secrets)
        return 0;
    if (token_check(&api->secrets, text, (long)time(NULL), &token, e) || check_revoked(api, &token, e)) {
        metrics_add(api->pipeline->metrics, METRIC_REFUSED_TOKEN, 1);
        return -1;
    }
    snprintf(key, sizeof key, "s %s", token.subject);
    if (!connection_count(principal->connection, key)) {
        metrics_add(api->pipeline->metrics, METRIC_REFUSED_LIMIT, 1);
        return error_plain(e, ERROR_TOO_MANY_PER_ADDRESS);
    }
    memcpy(principal->key, key, sizeof principal->key);
    principal->token = token;
    return 0;
}

int principal_enter(struct api *api, const struct http_request *request, struct principal *principal,
                    struct error *e) {
    char token[TOKEN_BYTES];
    *principal = (struct principal){.connection = request->connection};
    if (!api->options.secrets)
        principal->token.rights = RIGHTS_ALL;
    snprintf(principal->key, sizeof principal->key, "%s", connection_address(request->connection));
    find_token(request, token);
    return *token ? principal_show(api, principal, token, e) : 0;
}

int principal_may(const struct api *api, const struct principal *principal, enum right right,
                  const char *room, struct error *e) {
    const struct token *token = &principal->token;
    if (!api->options.secrets)
        return 0;
    int refused = 0;
    if (!token->rights)
        refused = error_plain(e, ERROR_TOKEN_NEEDED);
    else if (token->expires <= (long)time(NULL))
        refused = error_plain(e, ERROR_EXPIRED_TOKEN);
    else if (!(token->rights & right))
        refused = error_plain(e, ERROR_FORBIDDEN);
    else if (*token->room && room != principal_own_room && (!room || strcmp(room, token->room)))
        refused = error_set(e, ERROR_FORBIDDEN, "the token is for the room '%s'", token->room);
    if (refused)
        metrics_add(api->pipeline->metrics, METRIC_REFUSED_TOKEN, 1);
    return refused;
}

int principal_ask(struct api *api, const struct principal *principal, struct error *e) {
    if (quota_ask(&api->quota, principal->key, api->options.address_requests, shared_limits_now(api)))
        return 0;
    metrics_add(api->pipeline->metrics, METRIC_REFUSED_LIMIT, 1);
    return error_set(e, ERROR_TOO_MANY_REQUESTS, "the limit is %u requests per minute",
                     api->options.address_requests);
}

/* 32-bit FNV-1a. */
uint32_t principal_quota_key(const struct principal *principal) {
    uint32_t hash = 2166136261u;
    for (const char *c = principal->key; *c; c++)
        hash = (hash ^ (uint8_t)*c) * 16777619u;
    return hash ? hash : 1;
}

uint32_t principal_connection(const struct principal *principal) {
    return connection_number(principal->connection);
}

struct principal *exchange_principal(struct exchange *x) {
    return exchange_attached(x);
}

bool exchange_permits(struct exchange *x, enum right right, const char *room, int *result) {
    struct api *api = exchange_api(x);
    struct error e;
    if (!principal_origin_allowed(api, exchange_request(x))) {
        *result = exchange_refuse_origin(x);
        return false;
    }
    if (!right)
        return true;
    struct principal *principal = mem_alloc(sizeof *principal);
    exchange_attach(x, principal);
    bool refused = principal_enter(api, exchange_request(x), principal, &e) ||
                   principal_may(api, principal, right, room, &e) || principal_ask(api, principal, &e);
    if (refused)
        *result = exchange_error(x, &e);
    return !refused;
}

bool exchange_admits(struct exchange *x, int *result) {
    struct api *api = exchange_api(x);
    struct error e;
    struct principal *principal = mem_alloc(sizeof *principal);
    exchange_attach(x, principal);
    if (!principal_enter(api, exchange_request(x), principal, &e) && !principal_ask(api, principal, &e))
        return true;
    *result = exchange_error(x, &e);
    return false;
}
