/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/transport.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/http/transport_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    HANDSHAKE_SECONDS = 15, /* for TLS to begin */
    OUT_LEAST = 512,        /* initial size of the output buffer */
};

struct peer {
    struct transport *transport;
    struct lws *wsi; /* NULL: gone, or not there yet */
    void *owner;
    uint8_t *out; /* unsent bytes, after LWS_PRE bytes for libwebsockets; NULL: none */
    size_t out_size, out_cap;
    struct peer *next_due;
    int half; /* copy of the descriptor of a socket whose peer sends nothing more; -1: none */
    bool due; /* in the list of on_due */
    bool adopting, closing, failed;
    bool eof;       /* the peer sends nothing more, so reading is off */
    bool telling;   /* `sent` must be called */
    bool finishing; /* nothing more is written */
};

static int callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size);

static const struct lws_protocols protocols[] = {
    {.name = "faccia",
     .callback = callback,
     .rx_buffer_size = PEER_READ_BYTES,
     .tx_packet_size = PEER_WRITE_BYTES},
    {0},
};

static void on_due(uv_idle_t *idle);

/* Defers to the next loop iteration what must not run inside a callback of libwebsockets. */
static void later(struct peer *p) {
    struct transport *all = p->transport;
    if (p->due)
        return;
    p->due = true;
    p->next_due = all->due;
    all->due = p;
    uv_idle_start(all->idle, on_due);
}

static void gone(struct peer *p) {
    p->transport->calls.closed(p->owner);
    free(p->out);
    free(p);
}

static void adopt(struct peer *p, int fd, int type) {
    const lws_adopt_desc_t from = {.vh = p->transport->vhost,
                                   .type = (lws_adoption_type)type,
                                   .fd = {.sockfd = fd},
                                   .vh_prot_name = protocols->name,
                                   .opaque = p};
    p->adopting = true;
    bool adopted = lws_adopt_descriptor_vhost_via_info(&from) != NULL;
    p->adopting = false;
    if (adopted)
        return;
    p->failed = true;
    p->wsi = NULL;
    later(p);
}

/* libwebsockets closes a socket whose peer sends nothing more. A plain one continues on a copy of its
 * descriptor, with reading off. */
static void go_on_half(struct peer *p) {
    int fd = p->half;
    p->half = -1;
    p->eof = true;
    adopt(p, fd, LWS_ADOPT_SOCKET);
    if (p->wsi)
        lws_rx_flow_control(p->wsi, 0);
    if (p->wsi && (p->out_size || p->telling))
        lws_callback_on_writable(p->wsi);
    if (!p->failed)
        p->transport->calls.eof(p->owner);
}

static void on_due(uv_idle_t *idle) {
    struct transport *all = idle->data;
    uv_idle_stop(idle);
    for (struct peer *p; (p = all->due);) {
        all->due = p->next_due;
        p->due = false;
        if (p->half >= 0 && !p->closing) {
            go_on_half(p);
        } else if (p->closing && p->wsi) {
            lws_set_timeout(p->wsi, PENDING_TIMEOUT_KILLED_BY_PARENT, LWS_TO_KILL_SYNC); /* calls on_close */
        } else if (!p->wsi && (p->closing || p->failed)) {
            if (p->half >= 0)
                close(p->half);
            gone(p);
        }
    }
}

static bool is_half_closed(const struct peer *p, struct lws *wsi) {
    char byte;
    return !p->closing && !p->eof && !lws_get_ssl(wsi) &&
           recv(lws_get_socket_fd(wsi), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

static void on_close(struct peer *p, struct lws *wsi) {
    p->wsi = NULL;
    if (p->adopting)
        return;
    p->half = is_half_closed(p, wsi) && !lws_partial_buffered(wsi)
                  ? fcntl(lws_get_socket_fd(wsi), F_DUPFD_CLOEXEC, 3)
                  : -1;
    p->failed = p->half < 0;
    if (p->failed && !p->due) /* no list refers to it */
        gone(p);
    else
        later(p);
}

static void tell_end(struct peer *p) {
    if (lws_get_ssl(p->wsi))
        transport_end_tls(p->wsi);
    else
        shutdown(lws_get_socket_fd(p->wsi), SHUT_WR);
}

/* Returns -1 if the connection is broken. */
static int on_writable(struct peer *p) {
    if (p->closing)
        return 0;
    if (p->out_size) {
        int taken = lws_write(p->wsi, p->out + LWS_PRE, p->out_size, LWS_WRITE_RAW);
        free(p->out);
        p->out = NULL;
        p->out_size = p->out_cap = 0;
        if (taken < 0)
            return -1;
    }
    if (lws_partial_buffered(p->wsi)) /* libwebsockets calls again when it has been sent */
        return 0;
    if (p->finishing) {
        tell_end(p);
        if (p->eof) /* both sides have finished */
            peer_close(p);
    }
    if (p->telling) {
        p->telling = false;
        p->transport->calls.sent(p->owner);
    }
    return 0;
}

static int callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size) {
    struct peer *p = wsi ? lws_get_opaque_user_data(wsi) : NULL;
    (void)user;
    if (!p)
        return 0;
    switch (reason) {
    case LWS_CALLBACK_RAW_ADOPT:
        p->wsi = wsi;
        return 0;
    case LWS_CALLBACK_RAW_RX:
        if (!p->closing && size)
            p->transport->calls.read(p->owner, in, size);
        return 0;
    case LWS_CALLBACK_RAW_WRITEABLE:
        return on_writable(p);
    case LWS_CALLBACK_RAW_CLOSE:
        on_close(p, wsi);
        return 0;
    default:
        return 0;
    }
}

struct peer *peer_open(struct transport *all, int fd, void *owner) {
    struct peer *p = mem_alloc(sizeof *p);
    *p = (struct peer){.transport = all, .owner = owner, .half = -1};
    adopt(p, fd, LWS_ADOPT_SOCKET | LWS_ADOPT_ALLOW_SSL);
    return p;
}

bool peer_secure(const struct peer *p) {
    return p->wsi && lws_get_ssl(p->wsi);
}

/* Writes directly to the socket if nothing is queued and there is no TLS: a writeable callback per message
 * would cost more than the message. The rest waits for that callback. */
static size_t send_now(struct peer *p, const struct iovec *parts, size_t count) {
    const struct msghdr message = {.msg_iov = (struct iovec *)(uintptr_t)parts, .msg_iovlen = count};
    if (!p->wsi || p->telling || lws_get_ssl(p->wsi))
        return 0;
    ssize_t sent = sendmsg(lws_get_socket_fd(p->wsi), &message, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EAGAIN && errno != EINTR)
        peer_close(p);
    return sent < 0 ? 0 : (size_t)sent;
}

/* Buffers as much as fits, for the writeable callback. */
static size_t keep(struct peer *p, const void *bytes, size_t size) {
    size_t room = PEER_WRITE_BYTES - p->out_size, n = size < room ? size : room;
    if (p->out_size + n > p->out_cap) {
        size_t cap = 2 * p->out_cap > p->out_size + n ? 2 * p->out_cap : p->out_size + n;
        cap = cap < OUT_LEAST ? OUT_LEAST : cap > PEER_WRITE_BYTES ? PEER_WRITE_BYTES : cap;
        p->out = mem_resize(p->out, LWS_PRE + cap);
        p->out_cap = cap;
    }
    memcpy(p->out + LWS_PRE + p->out_size, bytes, n);
    p->out_size += n;
    return n;
}

size_t peer_write(struct peer *p, const struct iovec *parts, size_t count) {
    size_t all = 0, taken;
    for (size_t i = 0; i < count; i++)
        all += parts[i].iov_len;
    if (p->closing || p->failed || p->finishing || (taken = send_now(p, parts, count)) == all || p->closing)
        return all;
    size_t at = taken; /* bytes of the parts already sent */
    for (size_t i = 0; i < count; i++) {
        size_t left = parts[i].iov_len > at ? parts[i].iov_len - at : 0;
        size_t kept = keep(p, (const uint8_t *)parts[i].iov_base + (parts[i].iov_len - left), left);
        taken += kept;
        at = at > parts[i].iov_len ? at - parts[i].iov_len : 0;
        if (kept < left)
            break;
    }
    if (!p->telling && p->wsi)
        lws_callback_on_writable(p->wsi);
    p->telling = true;
    return taken;
}

size_t peer_unsent(const struct peer *p) {
    return p->out_size ? p->out_size : p->telling;
}

void peer_read(struct peer *p, bool on) {
    if (p->wsi && !p->eof && !p->closing)
        lws_rx_flow_control(p->wsi, on);
}

void peer_finish(struct peer *p) {
    if (p->finishing || p->closing || !p->wsi)
        return;
    p->finishing = true;
    if (!p->telling)
        lws_callback_on_writable(p->wsi);
}

void peer_close(struct peer *p) {
    if (p->closing)
        return;
    p->closing = true;
    later(p);
}

static void on_log(int level, const char *line) {
    char text[512];
    snprintf(text, sizeof text, "%.*s", (int)strcspn(line, "\n"), line);
    if (level == LLL_ERR)
        log_error("%s", text);
    else
        log_warn("%s", text);
}

struct transport *transport_open(uv_loop_t *loop, const struct peer_calls *calls,
                                 const struct transport_tls *tls, struct error *e) {
    static const lws_retry_bo_t none = {
        0}; /* no keepalive: the owner of a connection checks that its peer is alive */
    void *loops[] = {loop};
    if (tls && transport_check_tls(tls, e))
        return NULL;
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN_SERVER,
        .protocols = protocols,
        .foreign_loops = loops,
        .options = LWS_SERVER_OPTION_LIBUV | LWS_SERVER_OPTION_EXPLICIT_VHOSTS,
        .retry_and_idle_policy = &none,
        .timeout_secs = HANDSHAKE_SECONDS,
        .pt_serv_buf_size = PEER_READ_BYTES,
        .vhost_name = "faccia",
        .alpn = "http/1.1", /* never HTTP/2 (CVE-2026-19773) */
    };
    if (tls) {
        info.ssl_cert_filepath = tls->cert;
        info.ssl_private_key_filepath = tls->key;
        info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT | LWS_SERVER_OPTION_ALLOW_NON_SSL_ON_SSL_PORT |
                        LWS_SERVER_OPTION_ALLOW_HTTP_ON_HTTPS_LISTENER;
        info.ssl_options_set = transport_tls_options();
    }
    struct transport *all = mem_alloc(sizeof *all);
    *all = (struct transport){.calls = *calls, .idle = mem_alloc(sizeof *all->idle)};
    uv_idle_init(loop, all->idle);
    all->idle->data = all;
    lws_set_log_level(LLL_ERR | LLL_WARN, on_log);
    all->context = lws_create_context(&info);
    all->vhost = all->context ? lws_create_vhost(all->context, &info) : NULL;
    if (all->vhost)
        return all;
    error_set(e, ERROR_CANNOT_LISTEN, "libwebsockets cannot begin (is libwebsockets-evlib-uv installed?)");
    transport_close(all);
    uv_run(loop, UV_RUN_DEFAULT); /* until its handles are closed */
    transport_free(all);
    return NULL;
}

static void free_idle(uv_handle_t *idle) {
    free(idle);
}

void transport_close(struct transport *all) {
    if (!all->idle)
        return;
    on_due(all->idle);
    uv_close((uv_handle_t *)all->idle, free_idle);
    all->idle = NULL;
    if (all->context)
        lws_context_destroy(all->context); /* the first of two steps, on a foreign loop */
}

void transport_free(struct transport *all) {
    if (all->context)
        lws_context_destroy(all->context);
    free(all);
}
