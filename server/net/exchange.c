/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One HTTP request: how it comes and goes, and its answer's body, as the connection takes it. */
#include "server/base/mem.h"
#include "server/net/exchange_parts.h"
#include <stdlib.h>
#include <string.h>

enum { PIECE_BYTES = 65536, BEAT_MS = 15000 };

struct exchange *exchange_open(struct net *net, struct lws *wsi) {
    struct exchange *x = mem_alloc(sizeof *x);
    x->net = net;
    x->wsi = wsi;
    x->next = net->exchanges;
    x->self = &net->exchanges;
    if (x->next)
        x->next->self = &x->next;
    net->exchanges = x;
    return x;
}

void exchange_close(struct exchange *x) {
    *x->self = x->next;
    if (x->next)
        x->next->self = x->self;
    if (x->work.free) {
        x->work.free(x->work.self);
        x->net->works -= !x->work.endless;
    }
    guest_leave(x->net, &x->guest);
    free(x->owned);
    buf_free(&x->queue);
    free(x);
}

struct net *exchange_net(const struct exchange *x) {
    return x->net;
}

struct lws *exchange_wsi(const struct exchange *x) {
    return x->wsi;
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

uint64_t exchange_now(const struct exchange *x) {
    return uv_now(x->net->studio->loop);
}

static void look(struct exchange *x) {
    bool waits = x->chunked ? x->queue.size : x->body_size;
    if (x->cut)
        return;
    x->cut = waits && watch_stalled(x->net, x->wsi, "an HTTP client", x->progress);
    if (!x->cut && x->chunked && x->work.beat && exchange_now(x) - x->beat >= BEAT_MS) {
        x->beat = exchange_now(x);
        x->work.beat(x->work.self);
    }
}

void exchanges_look(struct net *net) {
    for (struct exchange *x = net->exchanges; x; x = x->next)
        look(x);
}

const char *exchange_query(const struct exchange *x, const char *name, char *value, size_t cap) {
    char key[64];
    snprintf(key, sizeof key, "%s=", name);
    return lws_get_urlarg_by_name(x->wsi, key, value, (int)cap);
}

bool exchange_permits(struct exchange *x, enum right right, const char *room, int *result) {
    struct error e;
    if (!guest_origin_allowed(x->net, x->wsi)) {
        metrics_add(x->net->studio->metrics, METRIC_REFUSED_ORIGIN, 1);
        error_set(&e, "forbidden-origin", "pages from there may not use this server");
        *result = exchange_error(x, 403, &e);
        return false;
    }
    if (!right)
        return true;
    bool refused = guest_enter(x->net, x->wsi, &x->guest, &e) ||
                   guest_may(x->net, &x->guest, right, room, &e) || guest_ask(x->net, &x->guest, &e);
    if (refused)
        *result = exchange_error(x,
                                 !strncmp(e.code, "too-many", 8) ? 429
                                 : !strcmp(e.code, "forbidden")  ? 403
                                                                 : 401,
                                 &e);
    return !refused;
}

void exchange_add(struct exchange *x, const void *data, size_t size) {
    if (!size)
        return;
    if (!x->queue.size)
        x->progress = exchange_now(x);
    buf_printf(&x->queue, "%zx\r\n", size);
    buf_add(&x->queue, data, size);
    buf_add(&x->queue, "\r\n", 2);
    lws_callback_on_writable(x->wsi);
}

void exchange_end(struct exchange *x) {
    buf_add(&x->queue, "0\r\n\r\n", 5);
    x->complete = true;
    lws_callback_on_writable(x->wsi);
}

size_t exchange_unsent(const struct exchange *x) {
    return x->queue.size;
}

int exchange_writeable(struct exchange *x) {
    if (!x->answered)
        return 0;
    uint8_t piece[LWS_PRE + PIECE_BYTES];
    const uint8_t *from = x->chunked ? x->queue.data : x->body;
    size_t left = x->chunked ? x->queue.size : x->body_size, size = left < PIECE_BYTES ? left : PIECE_BYTES;
    if (size) {
        memcpy(piece + LWS_PRE, from, size);
        bool last = x->complete && size == left;
        if (lws_write(x->wsi, piece + LWS_PRE, size, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0)
            return -1;
        x->progress = exchange_now(x);
        if (x->chunked) {
            buf_consume(&x->queue, size);
        } else {
            x->body += size;
            x->body_size -= size;
        }
        if (left > size)
            lws_callback_on_writable(x->wsi);
        if (x->work.sent)
            x->work.sent(x->work.self);
    }
    x->done = x->complete && size == left;
    return 0;
}
