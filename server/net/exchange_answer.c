/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The answer to an HTTP request: its head, and bodies of known length. */
#include "server/base/mem.h"
#include "server/net/exchange_parts.h"
#include <string.h>

enum { HEAD_BYTES = 2048 };

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

static bool is_head_request(const struct exchange *x) {
    return lws_hdr_total_length(x->wsi, WSI_TOKEN_HEAD_URI) > 0;
}

static int send_known(struct exchange *x, struct head *h, const void *body, size_t size) {
    h->failed |= lws_add_http_header_content_length(h->wsi, size, &h->at, h->end);
    x->body = body;
    x->body_size = is_head_request(x) ? 0 : size;
    x->complete = true;
    x->progress = exchange_now(x);
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
    x->beat = exchange_now(x);
    return head_send(&h);
}
