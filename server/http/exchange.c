/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One HTTP request: its lifecycle, its body, and the head and body of its response. */
#include "server/access/headers.h"
#include "server/base/json/error_json.h"
#include "server/base/mem.h"
#include "server/base/metrics.h"
#include "server/http/http_internal.h"
#include "server/http/static_files.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    KEEPALIVE_MS = 15000,
    WARNINGS_MOST = 8,
};

struct exchange *exchange_open(struct http_server *server, const struct http_request *request,
                               const struct exchange_session *session) {
    struct exchange *x = mem_alloc(sizeof *x);
    x->server = server;
    x->request = request;
    x->connection = request->connection;
    x->session = session;
    return x;
}

void exchange_close(struct exchange *x) {
    if (x->work.free) {
        x->work.free(x->work.self);
        x->server->pending -= !x->work.endless;
    }
    buf_free(&x->request_body);
    buf_free(&x->queue);
    free(x->warnings);
    free(x->attached);
    buf_free(&x->headers);
    free(x);
}

void *exchange_owner(const struct exchange *x) {
    return x->server->ctx;
}

const struct http_request *exchange_request(const struct exchange *x) {
    return x->request;
}

void exchange_attach(struct exchange *x, void *data) {
    free(x->attached);
    x->attached = data;
}

void *exchange_attached(const struct exchange *x) {
    return x->attached;
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
    x->server->pending += !work.endless;
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

static void exchange_flush(struct exchange *x);

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

/* sends as many queued bytes as there is room for */
static void exchange_flush(struct exchange *x) {
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

void exchange_expect_body(struct exchange *x, size_t most, enum error_code too_long) {
    x->body_most = most;
    x->body_too_long = too_long;
}

void exchange_take_body(struct exchange *x, const void *data, size_t size) {
    struct error e;
    if (exchange_streams_body(x)) {
        x->work.body(x->work.self, data, size);
        return;
    }
    if (x->answered || !x->body_most)
        return;
    if (x->request_body.size + size <= x->body_most) {
        buf_add(&x->request_body, data, size);
        return;
    }
    exchange_drop_body(x);
    error_set(&e, x->body_too_long, "the body may have at most %zu bytes", x->body_most);
    exchange_error(x, &e);
}

bool exchange_streams_body(const struct exchange *x) {
    return x->work.body && (!x->answered || (x->chunked && !x->complete));
}

const struct buf *exchange_body(const struct exchange *x) {
    return &x->request_body;
}

void exchange_drop_body(struct exchange *x) {
    buf_free(&x->request_body);
}

struct head {
    struct exchange *x;
    unsigned status;
};

static void head_add(struct head *h, const char *name, const char *value) {
    buf_printf(&h->x->queue, "%s: %s\r\n", name, value);
}

static void add_date(struct head *h) {
    char date[40];
    struct tm utc;
    time_t now = time(NULL);
    strftime(date, sizeof date, "%a, %d %b %Y %H:%M:%S GMT", gmtime_r(&now, &utc));
    head_add(h, "date", date);
}

/* Adds headers that some statuses require (RFC 9110). */
static void add_by_status(struct head *h, unsigned status) {
    if (status == 426) {
        head_add(h, "upgrade", "websocket");
        head_add(h, "sec-websocket-version", "13");
    }
    if (status == 429 || status == 503)
        head_add(h, "retry-after", status == 429 ? "60" : "5");
}

/* Reason phrases of RFC 9110, 15. */
static const char *reason_of(unsigned status) {
    static const struct {
        unsigned status;
        const char *reason;
    } reasons[] = {{200, "OK"},
                   {202, "Accepted"},
                   {204, "No Content"},
                   {304, "Not Modified"},
                   {308, "Permanent Redirect"},
                   {400, "Bad Request"},
                   {401, "Unauthorized"},
                   {403, "Forbidden"},
                   {404, "Not Found"},
                   {405, "Method Not Allowed"},
                   {408, "Request Timeout"},
                   {409, "Conflict"},
                   {412, "Precondition Failed"},
                   {413, "Content Too Large"},
                   {414, "URI Too Long"},
                   {415, "Unsupported Media Type"},
                   {417, "Expectation Failed"},
                   {421, "Misdirected Request"},
                   {426, "Upgrade Required"},
                   {428, "Precondition Required"},
                   {429, "Too Many Requests"},
                   {431, "Request Header Fields Too Large"},
                   {500, "Internal Server Error"},
                   {501, "Not Implemented"},
                   {503, "Service Unavailable"},
                   {505, "HTTP Version Not Supported"},
                   {507, "Insufficient Storage"}};
    for (size_t i = 0; i < sizeof reasons / sizeof *reasons; i++)
        if (reasons[i].status == status)
            return reasons[i].reason;
    return "";
}

static void head_begin(struct head *h, struct exchange *x, unsigned status) {
    h->x = x;
    h->status = status;
    x->answered = true;
    x->persists = x->session->persists(x->connection);
    buf_printf(&x->queue, "HTTP/1.1 %u %s\r\n", status, reason_of(status));
    head_add(h, "server", "faccia");
    add_date(h);
    add_by_status(h, status);
}

/* Tells the browser which pages may read the response (Fetch standard, CORS protocol). */
static void head_origin(struct head *h, const struct exchange *x) {
    const char *origin = http_header(x->request, "origin");
    if (x->shared) {
        head_add(h, "access-control-allow-origin", "*");
        return;
    }
    head_add(h, "vary", "origin");
    if (origin && *origin && x->server->calls->origin_allowed(x->server->ctx, x->request))
        head_add(h, "access-control-allow-origin", origin);
    if (x->warning_count || *x->etag)
        head_add(h, "access-control-expose-headers", "etag, faccia-warning");
}

/* Headers must be ASCII on one line. */
static void head_warnings(struct head *h, const struct exchange *x) {
    for (size_t i = 0; i < x->warning_count; i++) {
        json_t *warning = error_json(&x->warnings[i]);
        json_object_del(warning, "type");
        char *text = json_dumps(warning, JSON_COMPACT | JSON_ENSURE_ASCII);
        head_add(h, "faccia-warning", text);
        free(text);
        json_decref(warning);
    }
}

static void head_common(struct head *h, const struct exchange *x, const char *type) {
    struct headers headers;
    headers_of(&headers, type, x->shared || x->refused, x->embed);
    head_add(h, "content-type", type);
    for (size_t i = 0; i < headers.count; i++)
        head_add(h, headers.list[i].name, headers.list[i].value);
    if (*x->etag)
        head_add(h, "etag", x->etag);
    buf_add(&h->x->queue, x->headers.data, x->headers.size);
    if (x->server->options.hsts && connection_secure(x->connection)) {
        char age[48];
        snprintf(age, sizeof age, "max-age=%u", x->server->options.hsts);
        head_add(h, "strict-transport-security", age);
    }
    head_warnings(h, x);
    head_origin(h, x);
}

static void head_end(struct head *h) {
    struct exchange *x = h->x;
    if (!x->persists)
        head_add(h, "connection", h->status == 426 ? "upgrade, close" : "close");
    else if (h->status == 426)
        head_add(h, "connection", "upgrade");
    else if (!x->request->minor)
        head_add(h, "connection", "keep-alive");
    buf_add(&x->queue, "\r\n", 2);
}

static bool has_no_body(const struct exchange *x, unsigned status) {
    return x->request->method == HTTP_HEAD || status == 204 || status == 304;
}

/* copied: the body is copied; otherwise it must live as long as the server. */
static int send_known(struct exchange *x, struct head *h, const void *body, size_t size, bool copied) {
    char length[24];
    snprintf(length, sizeof length, "%zu", size);
    if (h->status != 204 && h->status != 304)
        head_add(h, "content-length", length);
    head_end(h);
    bool sent = !has_no_body(x, h->status);
    if (sent && copied)
        buf_add(&x->queue, body, size);
    x->body = body;
    x->body_size = sent && !copied ? size : 0;
    x->complete = true;
    exchange_flush(x);
    return 0;
}

int exchange_answer(struct exchange *x, unsigned status, const char *type, const void *body, size_t size) {
    struct head h;
    head_begin(&h, x, status);
    head_common(&h, x, type);
    head_add(&h, "cache-control", "no-store");
    return send_known(x, &h, body, size, true);
}

void exchange_header(struct exchange *x, const char *name, const char *value) {
    buf_printf(&x->headers, "%s: %s\r\n", name, value);
}

void exchange_embed(struct exchange *x, char *const *origins) {
    x->embed = origins;
}

int exchange_refuse_origin(struct exchange *x) {
    struct error e;
    metrics_add(x->server->metrics, METRIC_REFUSED_ORIGIN, 1);
    error_plain(&e, ERROR_FORBIDDEN_ORIGIN);
    x->refused = true;
    return exchange_error(x, &e);
}

void exchange_tag(struct exchange *x, const char *tag) {
    snprintf(x->etag, sizeof x->etag, "%s", tag);
}

int exchange_tagged(struct exchange *x, const char *type, const void *body, size_t size) {
    struct head h;
    etag_of(body, size, x->etag);
    const char *known = http_header(x->request, "if-none-match");
    bool unchanged = known && etag_listed(known, x->etag);
    head_begin(&h, x, unchanged ? 304 : 200);
    head_common(&h, x, type);
    head_add(&h, "cache-control", "no-cache");
    return send_known(x, &h, unchanged ? NULL : body, unchanged ? 0 : size, true);
}

int exchange_allow(struct exchange *x, unsigned status, const char *methods) {
    struct head h;
    head_begin(&h, x, status);
    head_add(&h, "allow", methods);
    head_origin(&h, x);
    head_add(&h, "access-control-allow-methods", methods);
    head_add(&h, "access-control-allow-headers", "authorization, content-type, if-match, if-none-match");
    head_add(&h, "access-control-max-age", "600");
    return send_known(x, &h, NULL, 0, true);
}

int exchange_redirect(struct exchange *x, const char *scheme) {
    const char *host = http_header(x->request, "host"), *target = (const char *)x->request->head.data;
    struct buf to = {0};
    struct head h;
    target += strcspn(target, " ") + 1; /* of the request line */
    int length = *target == '/' ? (int)strcspn(target, " ") : 0;
    if (!host || !*host) { /* HTTP/1.0 may omit it */
        struct error e;
        error_set(&e, ERROR_BAD_HOST, "this server wants TLS: %s", scheme);
        return exchange_error(x, &e);
    }
    buf_printf(&to, "%s://%s%.*s", scheme, host, length ? length : 1, length ? target : "/");
    head_begin(&h, x, 308);
    head_add(&h, "location", (const char *)to.data);
    head_add(&h, "cache-control", "no-store");
    buf_free(&to);
    return send_known(x, &h, NULL, 0, true);
}

int exchange_into_folder(struct exchange *x, const char *path) {
    struct head h;
    char to[256];
    snprintf(to, sizeof to, "%s/",
             strrchr(path, '/') + 1); /* relative, since a proxy may serve it at another address */
    head_begin(&h, x, 308);
    head_add(&h, "location", to);
    head_add(&h, "cache-control", "no-store");
    return send_known(x, &h, NULL, 0, true);
}

int exchange_json(struct exchange *x, unsigned status, json_t *object) {
    struct buf text = {0};
    json_t *warnings = x->warning_count && status < 400 ? json_array() : NULL;
    for (size_t i = 0; warnings && i < x->warning_count; i++) {
        json_t *warning = error_json(&x->warnings[i]);
        json_object_del(warning, "type");
        json_array_append_new(warnings, warning);
    }
    if (warnings)
        json_object_set_new(object, "warnings", warnings);
    json_write(&text, object);
    buf_add(&text, "\n", 1);
    int result = exchange_answer(x, status, "application/json", text.data, text.size);
    buf_free(&text);
    return result;
}

int exchange_error(struct exchange *x, const struct error *e) {
    return exchange_json(x, error_status(e->code), error_json(e));
}

static bool header_has(const struct exchange *x, const char *name, const char *word) {
    const char *value = http_header(x->request, name);
    return value && strstr(value, word);
}

int exchange_file(struct exchange *x, const struct static_file *a) {
    struct head h;
    char etag[64];
    x->shared = true;
    snprintf(etag, sizeof etag, "W/\"%s\"", a->hash);
    bool unchanged = header_has(x, "if-none-match", a->hash);
    bool packed = a->packed && header_has(x, "accept-encoding", "gzip");
    const char *asked = http_query(x->request, "v");
    head_begin(&h, x, unchanged ? 304 : 200);
    head_common(&h, x, a->type);
    head_add(&h, "etag", etag);
    head_add(&h, "vary", "accept-encoding");
    head_add(&h, "cache-control",
             asked && !strcmp(asked, a->hash) ? "public, max-age=31536000, immutable" : "no-cache");
    if (unchanged)
        return send_known(x, &h, NULL, 0, true);
    if (packed)
        head_add(&h, "content-encoding", "gzip");
    return send_known(x, &h, packed ? a->packed : a->data, packed ? a->packed_size : a->size, false);
}

int exchange_begin(struct exchange *x, const char *type) {
    struct head h;
    head_begin(&h, x, 200);
    head_common(&h, x, type);
    head_add(&h, "cache-control", "no-store");
    x->chunked = true;
    x->framed = x->request->minor > 0;
    x->persists &= x->framed;
    if (x->framed)
        head_add(&h, "transfer-encoding", "chunked");
    head_end(&h);
    x->complete = x->request->method == HTTP_HEAD;
    x->last_keepalive = connection_now(x->connection);
    exchange_flush(x);
    return 0;
}
