/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One HTTP request: how it comes and goes, and its answer's body, as the connection takes it. */
#include "server/base/mem.h"
#include "server/net/exchange_internal.h"
#include <stdlib.h>
#include <string.h>

enum { KEEPALIVE_MS = 15000 };

struct exchange *exchange_open(struct net *net, const struct http_request *request,
                               const struct exchange_session *session) {
    struct exchange *x = mem_alloc(sizeof *x);
    x->net = net;
    x->request = request;
    x->connection = request->connection;
    x->session = session;
    return x;
}

void exchange_close(struct exchange *x) {
    if (x->work.free) {
        x->work.free(x->work.self);
        x->net->works -= !x->work.endless;
    }
    buf_free(&x->request_body);
    buf_free(&x->queue);
    free(x->warnings);
    free(x);
}

struct net *exchange_net(const struct exchange *x) {
    return x->net;
}

const struct http_request *exchange_request(const struct exchange *x) {
    return x->request;
}

struct principal *exchange_principal(struct exchange *x) {
    return &x->principal;
}

void exchange_warn(void *exchange, const struct error *e) {
    struct exchange *x = exchange;
    if (!x->warnings)
        x->warnings = mem_alloc(WARNINGS_MOST * sizeof *x->warnings);
    if (x->warning_count < WARNINGS_MOST)
        x->warnings[x->warning_count++] = *e;
}

const struct error *exchange_warnings(const struct exchange *x, size_t *count) {
    *count = x->warning_count;
    return x->warnings;
}

void exchange_set_work(struct exchange *x, struct exchange_work work) {
    x->work = work;
    x->net->works += !work.endless;
}

struct exchange_work *exchange_get_work(struct exchange *x) {
    return x->work.self ? &x->work : NULL;
}

bool exchange_done(const struct exchange *x) {
    return x->done;
}

bool exchange_answered(const struct exchange *x) {
    return x->answered;
}

bool exchange_persists(const struct exchange *x) {
    return x->persists;
}

bool exchange_ends_with_client(const struct exchange *x) {
    return x->work.endless || (x->work.costly && !exchange_answered(x));
}

void exchange_look(struct exchange *x) {
    uint64_t now = connection_now(x->connection);
    if (x->chunked && !x->complete && x->work.keepalive && now - x->last_keepalive >= KEEPALIVE_MS) {
        x->last_keepalive = now;
        x->work.keepalive(x->work.self);
    }
}

const char *exchange_query(const struct exchange *x, const char *name, char *value, size_t cap) {
    const char *found = http_query(x->request, name);
    if (!found)
        return NULL;
    snprintf(value, cap, "%s", found);
    return value;
}

void exchange_add(struct exchange *x, const void *data, size_t size) {
    if (!size || x->complete)
        return;
    if (x->framed)
        buf_printf(&x->queue, "%zx\r\n", size);
    buf_add(&x->queue, data, size);
    if (x->framed)
        buf_add(&x->queue, "\r\n", 2);
    exchange_flush(x);
}

void exchange_end(struct exchange *x) {
    if (x->complete)
        return;
    if (x->framed)
        buf_add(&x->queue, "0\r\n\r\n", 5);
    x->complete = true;
    exchange_flush(x);
}

size_t exchange_unsent(const struct exchange *x) {
    return x->queue.size + x->body_size + connection_unsent(x->connection);
}

void exchange_flush(struct exchange *x) {
    if (x->queue.size)
        buf_consume(&x->queue, connection_send(x->connection, x->queue.data, x->queue.size));
    if (!x->queue.size && x->body_size) {
        size_t taken = connection_send(x->connection, x->body, x->body_size);
        x->body += taken;
        x->body_size -= taken;
    }
    if (x->complete && !x->queue.size && !x->body_size && !x->done) {
        x->done = true;
        x->session->answered(x->connection);
    }
}

void exchange_sent(struct exchange *x) {
    exchange_flush(x);
    if (x->work.sent && !x->done)
        x->work.sent(x->work.self);
}
