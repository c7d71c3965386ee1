/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One HTTP request and its answer: head, then the body piece by piece as the connection takes it. */
#include "server/base/mem.h"
#include "server/net/internal.h"
#include <stdlib.h>
#include <string.h>

enum { PIECE_BYTES = 65536, HEAD_BYTES = 2048, BEAT_MS = 15000 };

struct exchange {
    struct net *net;
    struct lws *wsi;
    struct exchange *next, **self; /* in the net's list */
    struct exchange_work work;
    const uint8_t *body; /* what is left of a body of known length */
    size_t body_size;
    void *owned;       /* that body's memory, if it is the exchange's */
    struct buf queue;  /* of an answer in chunks: what waits */
    uint64_t progress; /* loop time when bytes left last, or began to wait, ms */
    uint64_t beat;     /* loop time of the last beat, ms */
    bool cut;          /* the connection is */
    bool chunked, complete, answered, done;
    bool shared; /* any page may have the answer */
    struct guest guest;
};

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

/* The response's head is built here; any of its functions may find it full, which no header of ours makes it.
 */
struct head {
    struct lws *wsi;
    uint8_t bytes[LWS_PRE + HEAD_BYTES];
    unsigned char *at, *end;
    int failed;
};

static void head_begin(struct head *h, struct exchange *x, unsigned status) {
    h->wsi = x->wsi;
    h->at = h->bytes + LWS_PRE;
    h->end = h->bytes + sizeof h->bytes - 1;
    h->failed = lws_add_http_header_status(h->wsi, status, &h->at, h->end);
    x->answered = true;
}

static void head_add(struct head *h, const char *name, const char *value) {
    char field[64];
    snprintf(field, sizeof field, "%s:", name);
    h->failed |=
        lws_add_http_header_by_name(h->wsi, (const unsigned char *)field, (const unsigned char *)value,
                                    (int)strlen(value), &h->at, h->end);
}

/* Which pages a browser lets see the answer (Fetch standard, CORS protocol). */
static void head_origin(struct head *h, const struct exchange *x) {
    char origin[256];
    if (x->shared) {
        head_add(h, "access-control-allow-origin", "*");
        return;
    }
    head_add(h, "vary", "origin");
    if (lws_hdr_copy(x->wsi, origin, sizeof origin, WSI_TOKEN_ORIGIN) > 0 &&
        guest_origin_allowed(x->net, x->wsi))
        head_add(h, "access-control-allow-origin", origin);
}

static void head_common(struct head *h, const struct exchange *x, const char *type) {
    head_add(h, "content-type", type);
    head_add(h, "x-content-type-options", "nosniff");
    head_origin(h, x);
}

static int head_send(struct head *h) {
    return h->failed || lws_finalize_write_http_header(h->wsi, h->bytes + LWS_PRE, &h->at, h->end) ? -1 : 0;
}

static uint64_t now(const struct exchange *x) {
    return uv_now(x->net->studio->loop);
}

static void look(struct exchange *x) {
    bool waits = x->chunked ? x->queue.size : x->body_size;
    if (x->cut)
        return;
    x->cut = waits && watch_stalled(x->net, x->wsi, "an HTTP client", x->progress);
    if (!x->cut && x->chunked && x->work.beat && now(x) - x->beat >= BEAT_MS) {
        x->beat = now(x);
        x->work.beat(x->work.self);
    }
}

void exchanges_look(struct net *net) {
    for (struct exchange *x = net->exchanges; x; x = x->next)
        look(x);
}

static bool is_head_request(const struct exchange *x) {
    return lws_hdr_total_length(x->wsi, WSI_TOKEN_HEAD_URI) > 0;
}

static int send_known(struct exchange *x, struct head *h, const void *body, size_t size) {
    h->failed |= lws_add_http_header_content_length(h->wsi, size, &h->at, h->end);
    x->body = body;
    x->body_size = is_head_request(x) ? 0 : size;
    x->complete = true;
    x->progress = now(x);
    if (head_send(h))
        return -1;
    lws_callback_on_writable(x->wsi);
    return 0;
}

int exchange_answer(struct exchange *x, unsigned status, const char *type, const void *body, size_t size) {
    struct head h;
    x->owned = mem_alloc(size);
    memcpy(x->owned, body, size);
    head_begin(&h, x, status);
    head_common(&h, x, type);
    head_add(&h, "cache-control", "no-store");
    return send_known(x, &h, x->owned, size);
}

int exchange_allow(struct exchange *x, unsigned status, const char *methods) {
    struct head h;
    head_begin(&h, x, status);
    head_add(&h, "allow", methods);
    head_origin(&h, x);
    head_add(&h, "access-control-allow-methods", methods);
    head_add(&h, "access-control-allow-headers", "authorization, content-type");
    head_add(&h, "access-control-max-age", "600");
    return send_known(x, &h, NULL, 0);
}

int exchange_json(struct exchange *x, unsigned status, json_t *object) {
    struct buf text = {0};
    message_write(&text, object);
    buf_add(&text, "\n", 1);
    int result = exchange_answer(x, status, "application/json", text.data, text.size);
    buf_free(&text);
    return result;
}

int exchange_error(struct exchange *x, unsigned status, const struct error *e) {
    return exchange_json(x, status, message_error(e));
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

static bool header_has(const struct exchange *x, enum lws_token_indexes token, const char *word) {
    char value[512];
    return lws_hdr_copy(x->wsi, value, sizeof value, token) > 0 && strstr(value, word);
}

int exchange_asset(struct exchange *x, const struct asset *a) {
    struct head h;
    char etag[64], version[64];
    x->shared = true;
    snprintf(etag, sizeof etag, "W/\"%s\"", a->hash);
    bool unchanged = header_has(x, WSI_TOKEN_HTTP_IF_NONE_MATCH, a->hash);
    bool packed = a->packed && header_has(x, WSI_TOKEN_HTTP_ACCEPT_ENCODING, "gzip");
    const char *asked = lws_get_urlarg_by_name(x->wsi, "v=", version, sizeof version);
    head_begin(&h, x, unchanged ? 304 : 200);
    head_common(&h, x, a->type);
    head_add(&h, "etag", etag);
    head_add(&h, "vary", "accept-encoding");
    head_add(&h, "cache-control",
             asked && !strcmp(asked, a->hash) ? "public, max-age=31536000, immutable" : "no-cache");
    if (unchanged)
        return send_known(x, &h, NULL, 0);
    if (packed)
        head_add(&h, "content-encoding", "gzip");
    return send_known(x, &h, packed ? a->packed : a->data, packed ? a->packed_size : a->size);
}

int exchange_begin(struct exchange *x, const char *type) {
    struct head h;
    head_begin(&h, x, 200);
    head_common(&h, x, type);
    head_add(&h, "cache-control", "no-store");
    head_add(&h, "transfer-encoding", "chunked");
    x->chunked = true;
    x->beat = now(x);
    return head_send(&h);
}

void exchange_add(struct exchange *x, const void *data, size_t size) {
    if (!size)
        return;
    if (!x->queue.size)
        x->progress = now(x);
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
        x->progress = now(x);
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
