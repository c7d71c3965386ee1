/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/websocket_open.h"
#include "server/net/exchange_internal.h"
#include "server/net/socket_internal.h"
#include <ctype.h>
#include <openssl/evp.h>
#include <string.h>
#include <strings.h>

enum { KEY_CHARS = 24, ACCEPT_CHARS = 28, PROTOCOL_CHARS = 32 };

static int refuse(struct exchange *x, enum error_code code, const char *why) {
    struct error e;
    error_set(&e, code, "%s", why);
    exchange_error(x, &e);
    return -1;
}

/* 16 bytes in base64. */
static bool is_key(const char *key) {
    if (!key || strlen(key) != KEY_CHARS || strcmp(key + KEY_CHARS - 2, "=="))
        return false;
    for (size_t i = 0; i < KEY_CHARS - 2; i++)
        if (!isalnum((unsigned char)key[i]) && !strchr("+/", key[i]))
            return false;
    return true;
}

/* May one be opened here, now, by that page? */
static int check_place(struct exchange *x) {
    struct net *net = x->net;
    const struct http_request *r = x->request;
    if (r->method != HTTP_GET || !r->minor)
        return refuse(x, ERROR_BAD_HANDSHAKE, "a WebSocket is opened by a GET of HTTP/1.1");
    struct error e;
    if (principal_check_host(net, r, &e)) {
        exchange_error(x, &e);
        return -1;
    }
    if (strcmp(r->path, "/v1/stream"))
        return refuse(x, ERROR_NOT_FOUND, "no WebSocket is at this address");
    if (!principal_origin_allowed(net, r)) {
        metrics_add(net->pipeline->metrics, METRIC_REFUSED_ORIGIN, 1);
        return refuse(x, ERROR_FORBIDDEN_ORIGIN, "pages from there may not use this server");
    }
    if (net->draining) {
        metrics_add(net->pipeline->metrics, METRIC_REFUSED_LIMIT, 1);
        return refuse(x, ERROR_STOPPING, "the server is about to stop");
    }
    return 0;
}

static int check_handshake(struct exchange *x) {
    const struct http_request *r = x->request;
    const char *version = http_header(r, "sec-websocket-version");
    if (!version || strcmp(version, "13") || http_header_count(r, "sec-websocket-version") > 1)
        return refuse(x, ERROR_UPGRADE_REQUIRED,
                      "version 13 of the WebSocket protocol is the one that is supported");
    if (!is_key(http_header(r, "sec-websocket-key")) || http_header_count(r, "sec-websocket-key") > 1)
        return refuse(x, ERROR_BAD_HANDSHAKE, "Sec-WebSocket-Key must be 16 bytes in base64, once");
    if (r->chunked || r->content_length)
        return refuse(x, ERROR_BAD_HANDSHAKE, "a WebSocket is asked for without a body");
    return 0;
}

/* The first sub-protocol in the client's list that is spoken here; "" when it has no list. */
static int choose_protocol(struct exchange *x, char protocol[PROTOCOL_CHARS]) {
    static const char *const known[] = {"faccia.v1", TEXT_PROTOCOL};
    const char *word;
    size_t at = 0, length;
    *protocol = '\0';
    while (http_header_next(x->request, "sec-websocket-protocol", &at, &word, &length))
        for (size_t i = 0; i < sizeof known / sizeof *known; i++)
            if (length == strlen(known[i]) && !strncmp(word, known[i], length)) {
                strcpy(protocol, known[i]);
                return 0;
            }
    if (http_header(x->request, "sec-websocket-protocol"))
        return refuse(x, ERROR_UNKNOWN_PROTOCOL, "the sub-protocols are faccia.v1 and faccia.text.v1");
    return 0;
}

/* RFC 6455, 4.2.2, 5.4. */
static void accept_of(const char *key, char accept[ACCEPT_CHARS + 1]) {
    static const char constant[] = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
    char text[KEY_CHARS + sizeof constant];
    unsigned char digest[EVP_MAX_MD_SIZE];
    snprintf(text, sizeof text, "%s%s", key, constant);
    EVP_Digest(text, strlen(text), digest, NULL, EVP_sha1(), NULL);
    EVP_EncodeBlock((unsigned char *)accept, digest, 20);
}

static void open_socket(struct exchange *x, const char *protocol) {
    struct connection *c = x->request->connection;
    char accept[ACCEPT_CHARS + 1];
    struct buf head = {0};
    accept_of(http_header(x->request, "sec-websocket-key"), accept);
    buf_printf(&head,
               "HTTP/1.1 101 Switching Protocols\r\nupgrade: websocket\r\nconnection: upgrade\r\n"
               "sec-websocket-accept: %s\r\n",
               accept);
    if (*protocol)
        buf_printf(&head, "sec-websocket-protocol: %s\r\n", protocol);
    buf_add(&head, "\r\n", 2);
    socket_open(c, x->request, &head, !strcmp(protocol, TEXT_PROTOCOL));
    c->http = NULL;
    buf_free(&head);
}

bool websocket_asked(struct exchange *x) {
    char protocol[PROTOCOL_CHARS];
    if (!http_header_lists(x->request, "upgrade", "websocket") ||
        !http_header_lists(x->request, "connection", "upgrade"))
        return false;
    if (!check_place(x) && !check_handshake(x) && !choose_protocol(x, protocol))
        open_socket(x, protocol);
    return true;
}
