/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The answer to an HTTP request: its head, and bodies of known length. */
#include "server/access/headers.h"
#include "server/net/exchange_internal.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SECTION_NAME_MAX = 64 }; /* of a work's id, and of a section's number */

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

/* Those that some answers always have (RFC 9110). */
static void add_by_status(struct head *h, unsigned status) {
    if (status == 426) {
        head_add(h, "upgrade", "websocket");
        head_add(h, "sec-websocket-version", "13");
    }
    if (status == 429 || status == 503)
        head_add(h, "retry-after", status == 429 ? "60" : "5");
}

/* RFC 9110, 15. */
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

/* Which pages a browser lets see the answer (Fetch standard, CORS protocol). */
static void head_origin(struct head *h, const struct exchange *x) {
    const char *origin = http_header(x->request, "origin");
    if (x->shared) {
        head_add(h, "access-control-allow-origin", "*");
        return;
    }
    head_add(h, "vary", "origin");
    if (origin && *origin && principal_origin_allowed(x->net, x->request))
        head_add(h, "access-control-allow-origin", origin);
    if (x->warning_count || *x->etag)
        head_add(h, "access-control-expose-headers", "etag, faccia-warning");
}

/* In ASCII, and on one line. */
static void head_warnings(struct head *h, const struct exchange *x) {
    for (size_t i = 0; i < x->warning_count; i++) {
        json_t *warning = message_error(&x->warnings[i]);
        json_object_del(warning, "type");
        char *text = json_dumps(warning, JSON_COMPACT | JSON_ENSURE_ASCII);
        head_add(h, "faccia-warning", text);
        free(text);
        json_decref(warning);
    }
}

/* What --embed is for: texts and the face. The pages that change something or show what is said (operator,
 * editor, the makers of avatars) are framed by nobody, lest clicks are drawn into them. The path is NULL when
 * a request is refused before it is read. */
static bool is_for_frames(const char *path) {
    static const char *const pages[] = {"/", "/library.html", "/room.html"};
    for (size_t i = 0; path && i < sizeof pages / sizeof *pages; i++)
        if (!strcmp(path, pages[i]))
            return true;
    return path && !strncmp(path, "/library/", strlen("/library/"));
}

static void head_common(struct head *h, const struct exchange *x, const char *type) {
    struct headers headers;
    headers_of(&headers, type, x->shared || x->refused,
               is_for_frames(x->request->path) ? x->net->options.embed : NULL);
    head_add(h, "content-type", type);
    for (size_t i = 0; i < headers.count; i++)
        head_add(h, headers.list[i].name, headers.list[i].value);
    if (*x->etag)
        head_add(h, "etag", x->etag);
    if (x->net->options.hsts && connection_secure(x->connection)) {
        char age[48];
        snprintf(age, sizeof age, "max-age=%u", x->net->options.hsts);
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

/* The body is copied, or it lives as long as the net. */
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

int exchange_move(struct exchange *x, const char *scheme) {
    const char *host = http_header(x->request, "host"), *target = (const char *)x->request->head.data;
    struct buf to = {0};
    struct head h;
    target += strcspn(target, " ") + 1; /* of the request's line */
    int length = *target == '/' ? (int)strcspn(target, " ") : 0;
    if (!host || !*host) { /* HTTP/1.0 may not say it */
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
    snprintf(to, sizeof to, "%s/", strrchr(path, '/') + 1); /* relative: a proxy may serve it elsewhere */
    head_begin(&h, x, 308);
    head_add(&h, "location", to);
    head_add(&h, "cache-control", "no-store");
    return send_known(x, &h, NULL, 0, true);
}

int exchange_json(struct exchange *x, unsigned status, json_t *object) {
    struct buf text = {0};
    json_t *warnings = x->warning_count && status < 400 ? json_array() : NULL;
    for (size_t i = 0; warnings && i < x->warning_count; i++) {
        json_t *warning = message_error(&x->warnings[i]);
        json_object_del(warning, "type");
        json_array_append_new(warnings, warning);
    }
    if (warnings)
        json_object_set_new(object, "warnings", warnings);
    message_write(&text, object);
    buf_add(&text, "\n", 1);
    int result = exchange_answer(x, status, "application/json", text.data, text.size);
    buf_free(&text);
    return result;
}

int exchange_error(struct exchange *x, const struct error *e) {
    return exchange_json(x, error_status(e->code), message_error(e));
}

static bool header_has(const struct exchange *x, const char *name, const char *word) {
    const char *value = http_header(x->request, name);
    return value && strstr(value, word);
}

/* The page of texts: the browser asks for the section that the address names (`at`) together with the page's
 * scripts. With tokens it could not say whose it is. */
static void head_section(struct head *h, const struct exchange *x, const struct asset *a) {
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789-", digits[] = "0123456789";
    const struct net_options *options = &x->net->options;
    if (!options->library || options->secrets || strcmp(a->path, "/library.html") != 0)
        return;
    const char *at = http_query(x->request, "at");
    int work = at ? (int)strspn(at, letters) : 0;
    int number = work && work < SECTION_NAME_MAX && at[work] == ':' ? (int)strspn(at + work + 1, digits) : 0;
    const char *rest = number ? at + work + 1 + number : "-";
    if (number >= SECTION_NAME_MAX || (*rest && *rest != ':'))
        return;
    char link[256];
    snprintf(link, sizeof link, "<v1/library/works/%.*s/sections/%.*s>; rel=preload; as=fetch; crossorigin",
             work, at, number, at + work + 1);
    head_add(h, "link", link);
}

int exchange_asset(struct exchange *x, const struct asset *a) {
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
    head_section(&h, x, a);
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
