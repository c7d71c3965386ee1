/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The server itself: libwebsockets' context and the one callback that tells HTTP from WebSocket. */
#include "server/net/net.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/net/internal.h"
#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>

const struct net_options net_defaults = {
    .host = "127.0.0.1",
    .port = 8080,
    .text_bytes = 100000,
    .message_bytes = 262144,
    .play_bytes = 16777216,
    .queue = STREAM_QUEUE,
    .connections = 1000,
    .rooms = 100,
    .send_bytes = 262144,
    .send_bytes_max = 4194304,
    .lag_seconds = 5,
    .stall_seconds = 10,
    .ping_seconds = 30,
};

static struct net *net_of(struct lws *wsi) {
    return lws_context_user(lws_get_context(wsi));
}

/* HTTP: what follows from how the exchange stands after something was done for it. */
static int settle(struct session *session, struct lws *wsi, int result) {
    if (result || !session->exchange || !exchange_done(session->exchange))
        return result;
    exchange_close(session->exchange);
    session->exchange = NULL;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static int on_request(struct session *session, struct lws *wsi) {
    char *path;
    int length, method = lws_http_get_uri_and_method(wsi, &path, &length);
    if (method < 0)
        return -1;
    if (session->exchange)
        exchange_close(session->exchange);
    session->exchange = exchange_open(net_of(wsi), wsi);
    return routes_serve(session->exchange, path, (size_t)length, method);
}

static int on_body(struct session *session, const void *data, size_t size) {
    struct exchange_work *work = session->exchange ? exchange_get_work(session->exchange) : NULL;
    if (!work)
        return 0; /* a body that nobody asked for */
    if (!work->body)
        return 0;
    return data ? work->body(work->self, data, size) : work->body_end(work->self);
}

/* A WebSocket may be opened at one address only, and not when the house is full. */
static int on_upgrade(struct lws *wsi) {
    struct net *net = net_of(wsi);
    char path[64];
    if (lws_hdr_copy(wsi, path, sizeof path, WSI_TOKEN_GET_URI) < 0 || strcmp(path, "/v1/stream")) {
        lws_return_http_status(wsi, HTTP_STATUS_NOT_FOUND, NULL);
        return -1;
    }
    if (!guest_origin_allowed(net, wsi)) {
        metrics_add(net->studio->metrics, METRIC_REFUSED_ORIGIN, 1);
        lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, NULL);
        return -1;
    }
    if (net->draining || net->connections > net->options.connections) {
        metrics_add(net->studio->metrics, METRIC_REFUSED_LIMIT, 1);
        lws_return_http_status(wsi, HTTP_STATUS_SERVICE_UNAVAILABLE, NULL);
        return -1;
    }
    return 0;
}

/* What a client does not take shall wait here, where it can be left out, and not in the kernel, which would
 * hide minutes of it: so a connection can be written to only while less than this is unsent (tcp(7)). */
static void keep_kernel_short(struct lws *wsi) {
    enum { UNSENT_BYTES = 16384 };
    int bytes = UNSENT_BYTES;
    setsockopt(lws_get_socket_fd(wsi), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &bytes, sizeof bytes);
}

static int on_connection(struct net *net, int change) {
    net->connections += (unsigned)change;
    metrics_add(net->studio->metrics, METRIC_CONNECTIONS, change);
    if (change > 0)
        metrics_add(net->studio->metrics, METRIC_CONNECTIONS_TOTAL, 1);
    /* some room above the limit, so that a refusal can still be told */
    return change > 0 && net->connections > net->options.connections + 50 ? -1 : 0;
}

int net_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size) {
    struct session *session = user;
    switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
        return 0;
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
        keep_kernel_short(wsi);
        return on_connection(net_of(wsi), 1);
    case LWS_CALLBACK_WSI_DESTROY:
        return on_connection(net_of(wsi), -1);
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return on_upgrade(wsi);

    case LWS_CALLBACK_HTTP:
        return settle(session, wsi, on_request(session, wsi));
    case LWS_CALLBACK_HTTP_BODY:
        return settle(session, wsi, on_body(session, in, size));
    case LWS_CALLBACK_HTTP_BODY_COMPLETION:
        return settle(session, wsi, on_body(session, NULL, 0));
    case LWS_CALLBACK_HTTP_WRITEABLE:
        return session->exchange ? settle(session, wsi, exchange_writeable(session->exchange)) : 0;
    case LWS_CALLBACK_CLOSED_HTTP:
        if (session && session->exchange)
            exchange_close(session->exchange);
        if (session)
            session->exchange = NULL;
        return 0;

    case LWS_CALLBACK_ESTABLISHED:
        session->socket = socket_open(net_of(wsi), wsi);
        return 0;
    case LWS_CALLBACK_RECEIVE:
        socket_heard(session->socket);
        return socket_receive(session->socket, in, size);
    case LWS_CALLBACK_RECEIVE_PONG:
        socket_heard(session->socket);
        return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
        return socket_writeable(session->socket);
    case LWS_CALLBACK_CLOSED:
        if (session->socket)
            socket_close(session->socket);
        session->socket = NULL;
        return 0;
    default:
        return 0;
    }
}

/* Is every address that this host name stands for on loopback? */
static bool is_loopback(const char *host) {
    struct addrinfo *list;
    bool loopback = true;
    if (getaddrinfo(host, NULL, NULL, &list))
        return false;
    for (const struct addrinfo *a = list; a; a = a->ai_next) {
        if (a->ai_family == AF_INET)
            loopback &= ntohl(((struct sockaddr_in *)a->ai_addr)->sin_addr.s_addr) >> 24 == 127;
        else
            loopback &= a->ai_family == AF_INET6 &&
                        IN6_IS_ADDR_LOOPBACK(&((struct sockaddr_in6 *)a->ai_addr)->sin6_addr);
    }
    freeaddrinfo(list);
    return loopback;
}

static void on_log(int level, const char *line) {
    char text[512];
    snprintf(text, sizeof text, "%.*s", (int)strcspn(line, "\n"), line);
    if (level == LLL_ERR)
        log_error("%s", text);
    else
        log_warn("%s", text);
}

static int listen_on(struct net *net, struct error *e) {
    static const struct lws_protocols protocols[] = {
        {"http", net_callback, sizeof(struct session), 0, 0, NULL, 0},
        {"faccia.v1", net_callback, sizeof(struct session), 0, 0, NULL, 0},
        {"faccia.text.v1", net_callback, sizeof(struct session), 0, 0, NULL, 0},
        {0},
    };
    static const lws_retry_bo_t none = {0}; /* watch.c sees to it */
    void *loops[] = {net->studio->loop};
    struct lws_context_creation_info info = {
        .port = net->options.listen_count ? CONTEXT_PORT_NO_LISTEN : net->options.port,
        .iface = net->options.listen_count ? NULL : net->options.host,
        .protocols = protocols,
        .foreign_loops = loops,
        .options = LWS_SERVER_OPTION_LIBUV | LWS_SERVER_OPTION_EXPLICIT_VHOSTS |
                   LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND,
        .user = net,
        .retry_and_idle_policy = &none,
        .keepalive_timeout = 30,
        .timeout_secs = 15,
        .server_string = "faccia",
    };
    lws_set_log_level(LLL_ERR | LLL_WARN, on_log);
    net->context = lws_create_context(&info);
    net->vhost = net->context ? lws_create_vhost(net->context, &info) : NULL;
    listeners_open(net);
    watch_begin(net);
    if (!net->vhost)
        return error_set(e, "listen", "cannot listen on %s port %d (is another program there?)",
                         net->options.host, net->options.port);
    return 0;
}

struct net *net_open(const struct studio *studio, const struct net_options *options, struct error *e) {
    if (!options->remote && !options->listen_count && !is_loopback(options->host)) {
        error_in_field(e, "bad-field", "host",
                       "'%s' is not a loopback address; to be heard by other machines, say so with --remote",
                       options->host);
        return NULL;
    }
    if (options->remote && !options->secrets && !options->listen_count && !is_loopback(options->host)) {
        error_in_field(e, "bad-field", "host",
                       "'%s' can be reached by other machines: tokens are needed, so name a --token-file",
                       options->host);
        return NULL;
    }
    struct net *net = mem_alloc(sizeof *net);
    net->options = *options;
    net->studio = studio;
    if (assets_load(&net->assets, options->web, options->models, e) || listen_on(net, e)) {
        net_close(net);
        uv_run(studio->loop, UV_RUN_DEFAULT); /* libwebsockets' handles are closed before the net is freed */
        net_free(net);
        return NULL;
    }
    return net;
}

void net_change(struct net *net, const struct net_options *options) {
    struct net_options *o = &net->options;
    o->origins = options->origins;
    o->host_names = options->host_names;
    o->embed = options->embed;
    o->secrets = options->secrets;
    o->text_bytes = options->text_bytes;
    o->message_bytes = options->message_bytes;
    o->play_bytes = options->play_bytes;
    o->queue = options->queue;
    o->connections = options->connections;
    o->rooms = options->rooms;
    o->address_connections = options->address_connections;
    o->address_requests = options->address_requests;
    o->send_bytes = options->send_bytes;
    o->send_bytes_max = options->send_bytes_max;
    o->lag_seconds = options->lag_seconds;
    o->stall_seconds = options->stall_seconds;
    o->ping_seconds = options->ping_seconds;
    o->hold_seconds = options->hold_seconds;
}

void net_drain(struct net *net) {
    net->draining = true;
}

bool net_busy(const struct net *net) {
    return net->works || sockets_busy(net);
}

void net_dismiss(struct net *net, const char *reason) {
    sockets_dismiss(net, reason);
}

int net_port(const struct net *net) {
    return lws_get_vhost_listen_port(net->vhost);
}

void net_set_ready(struct net *net) {
    net->ready = true;
}

void net_close(struct net *net) {
    listeners_close(net);
    watch_end(net);
    if (net->context)
        lws_context_destroy(net->context);
}

/* libwebsockets on libuv is destroyed in two steps: the second frees, once the loop has closed its handles.
 */
void net_free(struct net *net) {
    if (net->context)
        lws_context_destroy(net->context);
    assets_free(&net->assets);
    tally_free(&net->tally);
    hold_free(&net->hold);
    json_decref(net->more_languages);
    free(net);
}
