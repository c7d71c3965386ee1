/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP on one connection: its requests, one after the other, and their timeouts. */
#include "server/base/mem.h"
#include "server/base/metrics.h"
#include "server/http/http_internal.h"
#include "server/http/http_reader.h"
#include <stdlib.h>
#include <string.h>

enum {
    PENDING_BYTES = 65536, /* of requests that arrive before the current one is answered */
    DROP_BYTES = 65536,    /* of a body to be read and discarded */
    IDLE_MS = 30000,       /* without a request */
    HEAD_MS = 15000,       /* for the head of a request */
    BODY_MS = 15000,       /* without a byte of the body, and for the whole body */
    BODY_BYTES_MS = 1,     /* additional time for each byte of the body */
};

struct http_session {
    struct http_reader reader;
    struct exchange *exchange; /* the request being answered; NULL: none */
    struct buf pending;        /* bytes received meanwhile */
    uint64_t began;            /* loop time when the current wait began, ms */
    uint64_t last_rx;          /* loop time of the last bytes, ms */
    uint64_t body;             /* bytes of the body so far */
    bool complete;             /* the current request has arrived completely */
    bool served;               /* a response has been sent on this connection */
    bool advancing;            /* advance() is running */
    bool eof;                  /* the peer sends nothing more */
    bool last;                 /* no further request is answered */
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

/* Refuses a request before the owner of the server sees it. */
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

/* Refuses clients above the limits, but still answers the operator's /healthz and /metrics. */
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

/* Redirects clients on other machines from plain HTTP to TLS, if it is configured (RFC 9110, 15.4.9).
 * Programs on this machine may use plain HTTP, which no one can intercept. */
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

/* Ends the current exchange, whose response has been sent. */
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

/* Returns how many bytes were handled. The others must wait, or are no longer HTTP. */
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

/* Passes the remaining bytes to the WebSocket that replaced HTTP on the connection. */
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

/* A client that closes its side may still read, so it is answered. Most such clients have gone, though:
 * event streams and costly work end at once. */
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
    if (h->exchange &&
        exchange_streams_body(h->exchange)) /* the code that speaks the text has its own timeout */
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
