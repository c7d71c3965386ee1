/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/websocket_client.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include <libwebsockets.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPEN_SECONDS = 10,     /* to open the connection */
    AGAIN_MS = 500,        /* before the first reconnect; doubles each time */
    AGAIN_MOST_MS = 10000, /* longest delay before a reconnect */
    STEADY_MS = 5000,      /* a connection open for this long resets the delay */
    KEEPALIVE_SECONDS = 30,
};

struct outgoing {
    struct outgoing *next;
    bool binary;
    size_t size;
    uint8_t bytes[]; /* after LWS_PRE bytes for libwebsockets */
};

struct websocket_client {
    uv_loop_t *loop;
    uv_timer_t timer;
    struct lws_context *context;
    struct lws_vhost *vhost;
    struct lws *wsi; /* NULL: none */
    char *address, *path, *bearer, *origin_host;
    int port;
    bool tls, again, closed;
    bool open, starting, too_long, failed; /* failed: during start() */
    char why[128];                         /* reason of the failure */
    struct websocket_calls calls;
    void *ctx;
    struct buf come;
    struct outgoing *first, **last;
    size_t unsent;
    unsigned wait;  /* before the next reconnect, ms */
    uint64_t since; /* loop time when it was opened, ms */
};

const char websocket_unreachable[] = "it cannot be connected to";

static int callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size);

static const struct lws_protocols protocols[] = {
    {.name = "faccia-client", .callback = callback, .rx_buffer_size = 65536},
    {0},
};

static void on_again(uv_timer_t *timer);

static void drop_outgoing(struct websocket_client *c) {
    for (struct outgoing *o; (o = c->first);) {
        c->first = o->next;
        free(o);
    }
    c->last = &c->first;
    c->unsent = 0;
}

static void lose(struct websocket_client *c, const char *why) {
    c->wsi = NULL;
    if (c->starting) { /* start() reports it */
        c->failed = true;
        snprintf(c->why, sizeof c->why, "%s", why);
        return;
    }
    if (c->open && uv_now(c->loop) - c->since >= STEADY_MS)
        c->wait = AGAIN_MS;
    c->open = false;
    c->come.size = 0;
    drop_outgoing(c);
    if (c->closed)
        return;
    if (c->again) {
        uv_timer_start(&c->timer, on_again, c->wait, 0);
        c->wait = c->wait * 2 < AGAIN_MOST_MS ? c->wait * 2 : AGAIN_MOST_MS;
    }
    c->calls.lost(c->ctx, why);
}

static void start(struct websocket_client *c) {
    const struct lws_client_connect_info info = {
        .context = c->context,
        .vhost = c->vhost,
        .address = c->address,
        .port = c->port,
        .ssl_connection = c->tls ? LCCSCF_USE_SSL : 0,
        .path = c->path,
        .host = c->origin_host,
        .ietf_version_or_minus_one = -1,
        .local_protocol_name = protocols->name,
        .alpn = "http/1.1",
        .pwsi = &c->wsi,
        .opaque_user_data = c,
    };
    c->starting = true;
    c->failed = c->too_long = false;
    snprintf(c->why, sizeof c->why, "%s", websocket_unreachable);
    bool begun = lws_client_connect_via_info(&info) != NULL;
    c->starting = false;
    if (!begun || c->failed)
        lose(c, c->why);
}

static void on_again(uv_timer_t *timer) {
    start(timer->data);
}

/* Returns -1 to give up the connection. */
static int take(struct websocket_client *c, struct lws *wsi, const void *bytes, size_t size) {
    if (lws_frame_is_binary(wsi) || c->closed)
        return 0;
    if (c->come.size + size > WEBSOCKET_TEXT_MOST) {
        c->too_long = true;
        return -1;
    }
    buf_add(&c->come, bytes, size);
    if (!lws_is_final_fragment(wsi) || lws_remaining_packet_payload(wsi))
        return 0;
    struct buf text = c->come;
    c->come = (struct buf){0};
    c->calls.text(c->ctx, (const char *)text.data, text.size);
    buf_free(&text);
    return 0;
}

static int send_next(struct websocket_client *c) {
    struct outgoing *o = c->first;
    if (!o || lws_partial_buffered(c->wsi))
        return 0;
    int taken = lws_write(c->wsi, o->bytes + LWS_PRE, o->size, o->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT);
    c->first = o->next;
    if (!c->first)
        c->last = &c->first;
    c->unsent -= o->size;
    free(o);
    lws_callback_on_writable(c->wsi);
    return taken < 0 ? -1 : 0;
}

static int append_token(const struct websocket_client *c, struct lws *wsi, void *in, size_t size) {
    unsigned char **at = in, *end = *at + size;
    if (!c->bearer)
        return 0;
    return lws_add_http_header_by_name(wsi, (const unsigned char *)"authorization:",
                                       (const unsigned char *)c->bearer, (int)strlen(c->bearer), at, end);
}

/* Translates the reason of libwebsockets for a failed connection. "HS: " begins those about the
 * handshake's response. */
static const char *reason_of(const void *in) {
    const char *why = in;
    if (!why || !*why || !strcmp(why, "closed before established"))
        return websocket_unreachable;
    return strncmp(why, "HS: ", 4) ? why : "there is no WebSocket";
}

static int callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size) {
    struct websocket_client *c = wsi ? lws_get_opaque_user_data(wsi) : NULL;
    (void)user;
    if (!c)
        return 0;
    switch (reason) {
    case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER:
        return append_token(c, wsi, in, size);
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
        lose(c, reason_of(in));
        return 0;
    case LWS_CALLBACK_CLIENT_ESTABLISHED:
        c->open = true;
        c->since = uv_now(c->loop);
        if (!c->closed)
            c->calls.open(c->ctx);
        lws_callback_on_writable(wsi);
        return 0;
    case LWS_CALLBACK_CLIENT_RECEIVE:
        return take(c, wsi, in, size);
    case LWS_CALLBACK_CLIENT_WRITEABLE:
        return send_next(c);
    case LWS_CALLBACK_CLIENT_CLOSED:
    case LWS_CALLBACK_CLOSED_CLIENT_HTTP:
    case LWS_CALLBACK_WSI_DESTROY: /* a connection that dies during the handshake is not always reported
                                      otherwise */
        if (wsi == c->wsi)
            lose(c, c->too_long ? "it sends a message that is too long" : "it was closed");
        return 0;
    default:
        return 0;
    }
}

static bool read_url(struct websocket_client *c, const char *url) {
    static const char *const known[] = {"ws", "wss", "http", "https"};
    char *copy = mem_strdup(url);
    const char *scheme = NULL, *address = NULL, *path = NULL;
    bool good = strstr(url, "://") && !lws_parse_uri(copy, &scheme, &address, &c->port, &path) && *address &&
                c->port > 0 && c->port < 65536;
    bool spoken = false;
    for (size_t i = 0; good && i < sizeof known / sizeof *known; i++)
        spoken |= !strcmp(scheme, known[i]);
    if (good && spoken) {
        struct buf text = {0};
        size_t n = strlen(scheme);
        c->tls = scheme[n - 1] == 's' && strcmp(scheme, "ws") != 0;
        c->address = mem_strdup(address);
        buf_printf(&text, "/%s", path);
        c->path = (char *)text.data;
        const char *host = strstr(url, "://") + 3; /* as written, with the port */
        c->origin_host = mem_strndup(host, strcspn(host, "/?#"));
    }
    free(copy);
    return good && spoken;
}

struct websocket_client *websocket_client_new(uv_loop_t *loop, const char *url, const char *token, bool again,
                                              const struct websocket_calls *calls, void *ctx) {
    struct websocket_client *c = mem_alloc(sizeof *c);
    struct buf bearer = {0};
    void *loops[] = {loop};
    *c = (struct websocket_client){
        .loop = loop, .again = again, .calls = *calls, .ctx = ctx, .last = &c->first, .wait = AGAIN_MS};
    if (!read_url(c, url)) {
        free(c);
        return NULL;
    }
    if (token) {
        buf_printf(&bearer, "Bearer %s", token);
        c->bearer = (char *)bearer.data;
    }
    const struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN,
        .protocols = protocols,
        .foreign_loops = loops,
        .options = LWS_SERVER_OPTION_LIBUV | LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
                   LWS_SERVER_OPTION_VALIDATE_UTF8 | (c->tls ? LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT : 0),
        .timeout_secs = OPEN_SECONDS,
        .connect_timeout_secs = OPEN_SECONDS,
        .ka_time = KEEPALIVE_SECONDS,
        .ka_probes = 3,
        .ka_interval = KEEPALIVE_SECONDS / 3,
        .vhost_name = "faccia-client",
    };
    lws_set_log_level(0, NULL); /* errors are reported to the caller */
    uv_timer_init(loop, &c->timer);
    c->timer.data = c;
    c->context = lws_create_context(&info);
    c->vhost = c->context ? lws_create_vhost(c->context, &info) : NULL;
    uv_timer_start(&c->timer, on_again, 0,
                   0); /* deferred, so that the caller has the client before any callback */
    return c;
}

static void put(struct websocket_client *c, const void *bytes, size_t size, bool binary) {
    if (c->closed || !c->wsi)
        return;
    struct outgoing *o = mem_resize(NULL, sizeof *o + LWS_PRE + size);
    *o = (struct outgoing){.binary = binary, .size = size};
    memcpy(o->bytes + LWS_PRE, bytes, size);
    *c->last = o;
    c->last = &o->next;
    c->unsent += size;
    if (c->open)
        lws_callback_on_writable(c->wsi);
}

void websocket_client_text(struct websocket_client *c, const char *text, size_t size) {
    put(c, text, size, false);
}

void websocket_client_binary(struct websocket_client *c, const void *bytes, size_t size) {
    put(c, bytes, size, true);
}

size_t websocket_client_unsent(const struct websocket_client *c) {
    return c->unsent;
}

void websocket_client_close(struct websocket_client *c) {
    if (!c || c->closed)
        return;
    c->closed = true;
    uv_close((uv_handle_t *)&c->timer, NULL);
    if (c->context)
        lws_context_destroy(c->context); /* the first of two steps, on a foreign loop */
}

void websocket_client_free(struct websocket_client *c) {
    if (!c)
        return;
    if (c->context)
        lws_context_destroy(c->context);
    drop_outgoing(c);
    buf_free(&c->come);
    free(c->address);
    free(c->path);
    free(c->bearer);
    free(c->origin_host);
    free(c);
}
