/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP on one connection: its requests, one after the other, and how long they may take. */
#include "server/base/mem.h"
#include "server/base/metrics.h"
#include "server/http/http_internal.h"
#include "server/http/http_reader.h"
#include <stdlib.h>
#include <string.h>

enum {
    PENDING_BYTES = 65536, /* of requests that came before the present one was answered */
    DROP_BYTES = 65536,    /* of a body that nobody wants, to be read all the same */
    IDLE_MS = 30000,       /* without a request */
    HEAD_MS = 15000,       /* for a request's head */
    BODY_MS = 15000,       /* for a body, and without a byte of it, */
    BODY_BYTES_MS = 1,     /* and so much more for each byte of it */
};

struct http_session {
    struct http_reader reader;
    struct exchange *exchange; /* the request that is being answered; NULL = none */
    struct buf pending;        /* what came meanwhile */
    uint64_t began;            /* loop time when what is waited for began, ms */
    uint64_t last_rx;          /* and when the last of it came */
    uint64_t body;             /* bytes of the body so far */
    bool complete;             /* all of the present request has come */
    bool served;               /* an answer has been given on this connection */
    bool advancing;            /* its functions are at work */
    bool eof;                  /* nothing more will come */
    bool last;                 /* nothing more will be answered */
};

static void free_session(struct http_session *h) {
    if (!h)
        return;
    if (h->exchange)
        exchange_close(h->exchange);
    http_reader_free(&h->reader);
    buf_free(&h->pending);
    free(h);
}

static bool persists(const struct connection *c) {
    const struct http_session *h = c->http;
    const struct http_request *r = &h->reader.request;
    bool rest = h->complete || (!r->expects_continue && !r->chunked && r->content_length <= DROP_BYTES);
    return r->keep_alive && rest && !h->last && !c->surplus && !c->crowded && !c->server->draining;
}

static void answered(struct connection *c) {
    if (c->http && !c->http->advancing)
        connection_later(c);
}

static const struct exchange_session session = {persists, answered};

/* A request that is refused before anybody else hears of it. */
static void refuse(struct connection *c, const struct error *e) {
    struct http_session *h = c->http;
    h->last = true;
    if (!h->exchange)
        h->exchange = exchange_open(c->server, &h->reader.request, &session);
    if (exchange_answered(h->exchange))
        connection_close(c);
    else
        exchange_error(h->exchange, e);
}

/* Somebody above the limits: the operator's questions are answered all the same. */
static bool turned_away(struct connection *c) {
    const struct http_request *r = &c->http->reader.request;
    struct error e;
    bool asks_how = !strcmp(r->path, "/healthz") || !strcmp(r->path, "/metrics");
    if (!c->crowded && (!c->surplus || asks_how))
        return false;
    error_plain(&e, c->crowded ? ERROR_TOO_MANY_PER_ADDRESS : ERROR_TOO_MANY_CONNECTIONS);
    metrics_add(c->server->metrics, METRIC_REFUSED_LIMIT, 1);
    refuse(c, &e);
    return true;
}

/* Whoever comes from another machine without TLS, where there is TLS, is sent to the same address with it
 * (RFC 9110, 15.4.9). What this machine's own programs say is heard by nobody else. */
static bool sent_to_tls(struct connection *c) {
    if (!c->server->options.tls || c->local || connection_secure(c))
        return false;
    exchange_redirect(c->http->exchange, "https");
    return true;
}

static void begin(struct connection *c) {
    static const char proceed[] = "HTTP/1.1 100 Continue\r\n\r\n";
    struct http_session *h = c->http;
    struct http_request *r = &h->reader.request;
    h->began = h->last_rx = connection_now(c);
    h->body = 0;
    h->complete = false;
    h->exchange = exchange_open(c->server, r, &session);
    if (turned_away(c) || sent_to_tls(c))
        return;
    if (http_header_lists(r, "upgrade", "websocket") && http_header_lists(r, "connection", "upgrade")) {
        c->server->calls->upgrade(c->server->ctx, h->exchange);
        return;
    }
    c->server->calls->serve(c->server->ctx, h->exchange);
    if (r->expects_continue && !exchange_answered(h->exchange))
        connection_send(c, proceed, strlen(proceed));
}

static void body(struct connection *c) {
    struct http_session *h = c->http;
    h->last_rx = connection_now(c);
    h->body += h->reader.body_size;
    if (h->exchange)
        exchange_take_body(h->exchange, h->reader.body, h->reader.body_size);
}

static void end(struct connection *c) {
    struct http_session *h = c->http;
    struct exchange_work *work = h->exchange ? exchange_get_work(h->exchange) : NULL;
    h->complete = true;
    if (work && work->body_end && (!exchange_answered(h->exchange) || exchange_streams_body(h->exchange)))
        work->body_end(work->self);
}

/* The present answer has left. */
static void settle(struct connection *c) {
    struct http_session *h = c->http;
    bool goes_on = exchange_persists(h->exchange) && !h->last;
    exchange_close(h->exchange);
    h->exchange = NULL;
    h->served = true;
    h->began = h->last_rx = connection_now(c);
    if (!goes_on) {
        h->last = true;
        connection_finish(c);
    }
}

static bool is_over(const struct connection *c) {
    return c->closing || c->finished || !c->http;
}

/* Returns how many of the bytes were dealt with. The others have to wait, or are not HTTP any more. */
static size_t advance(struct connection *c, const uint8_t *bytes, size_t size) {
    struct http_session *h = c->http;
    size_t at = 0, used;
    h->advancing = true;
    while (!is_over(c)) {
        if (h->exchange && exchange_done(h->exchange)) {
            settle(c);
            continue;
        }
        if (h->exchange && (h->complete || h->last))
            break;
        enum http_event event = http_reader_feed(&h->reader, bytes + at, size - at, &used);
        at += used;
        if (event == HTTP_READ_MORE)
            break;
        if (event == HTTP_READ_HEAD)
            begin(c);
        else if (event == HTTP_READ_BODY)
            body(c);
        else if (event == HTTP_READ_END)
            end(c);
        else
            refuse(c, &h->reader.error);
    }
    if (c->http)
        h->advancing = false;
    return at;
}

/* What is left after the connection has become a WebSocket is that one's. */
static void hand_over(struct connection *c, struct http_session *h, const uint8_t *rest, size_t size) {
    free_session(h);
    if (size && !c->closing)
        c->protocol->read(c, (const char *)rest, size);
}

static void go_on(struct connection *c) {
    struct http_session *h = c->http;
    struct buf pending = h->pending;
    h->pending = (struct buf){0};
    size_t used = advance(c, pending.data, pending.size);
    if (!c->http) {
        hand_over(c, h, pending.data + used, pending.size - used);
    } else if (!is_over(c)) {
        buf_add(&h->pending, pending.data + used, pending.size - used);
        connection_read(c, !h->eof && h->pending.size < PENDING_BYTES);
        if (h->eof && !h->exchange)
            connection_finish(c);
    }
    buf_free(&pending);
}

static void take_bytes(struct connection *c, const char *bytes, size_t size) {
    struct http_session *h = c->http;
    if (h->last)
        return;
    if (h->complete && !h->exchange && !http_reader_begun(&h->reader))
        h->began = connection_now(c);
    if (h->pending.size || (h->exchange && h->complete)) {
        buf_add(&h->pending, bytes, size);
        if (!h->exchange || exchange_done(h->exchange))
            go_on(c);
        else if (h->pending.size >= PENDING_BYTES)
            connection_read(c, false);
        return;
    }
    size_t used = advance(c, (const uint8_t *)bytes, size);
    if (!c->http)
        hand_over(c, h, (const uint8_t *)bytes + used, size - used);
    else if (!is_over(c))
        buf_add(&h->pending, (const uint8_t *)bytes + used, size - used);
}

/* A client that closes its side may still read: it is answered. Most, however, have left; so what only sends
 * events ends, and what costs much is not worth the doubt. */
static void on_eof(struct connection *c) {
    struct http_session *h = c->http;
    h->eof = true;
    if (!h->exchange || !h->complete || exchange_ends_with_client(h->exchange))
        connection_close(c);
}

static void on_sent(struct connection *c) {
    struct http_session *h = c->http;
    if (h->exchange)
        exchange_sent(h->exchange);
    if (!h->exchange || exchange_done(h->exchange))
        go_on(c);
}

bool http_session_is_idle(const struct connection *c) {
    const struct http_session *h = c->http;
    return !h->exchange && h->served && h->complete && !h->pending.size && !http_reader_begun(&h->reader);
}

static bool is_late(const struct connection *c) {
    const struct http_session *h = c->http;
    uint64_t now = connection_now(c);
    if (h->exchange && exchange_streams_body(h->exchange)) /* its writer is watched by who speaks it */
        return false;
    if (h->exchange && !h->complete)
        return now - h->last_rx > BODY_MS || now - h->began > BODY_MS + BODY_BYTES_MS * h->body;
    if (h->exchange)
        return false;
    return now - h->began > (http_session_is_idle(c) ? IDLE_MS : HEAD_MS);
}

static void look(struct connection *c) {
    struct http_session *h = c->http;
    struct error e;
    if (h->exchange)
        exchange_look(h->exchange);
    if (!is_late(c) || h->last)
        return;
    if (!h->exchange && !http_reader_begun(&h->reader)) {
        connection_close(c);
    } else if (h->exchange && exchange_answered(h->exchange)) {
        connection_close(c);
    } else {
        error_plain(&e, ERROR_REQUEST_TIMEOUT);
        refuse(c, &e);
        go_on(c);
    }
}

static void drop(struct connection *c) {
    free_session(c->http);
    c->http = NULL;
}

void http_session_open(struct connection *c) {
    static const struct connection_protocol protocol = {
        .read = take_bytes, .eof = on_eof, .sent = on_sent, .go_on = go_on, .look = look, .free = drop};
    struct http_session *h = c->http = mem_alloc(sizeof *h);
    h->reader.request.connection = c;
    h->began = connection_now(c);
    c->name = "an HTTP client";
    connection_use(c, &protocol);
}
