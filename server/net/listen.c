/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sockets that somebody else (systemd) has opened and listens on: libwebsockets takes no such socket, but it
 * adopts the connections that are accepted here. */
#include "server/base/mem.h"
#include "server/net/internal.h"
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

struct listener {
    struct net *net;
    int fd;
    uv_poll_t poll;
};

static void on_connection(uv_poll_t *poll, int status, int events) {
    struct listener *listener = poll->data;
    (void)events;
    if (status)
        return;
    int fd = accept4(listener->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd >= 0)
        lws_adopt_socket_vhost(listener->net->vhost, fd); /* closes it when it cannot */
}

void listeners_open(struct net *net) {
    net->listeners = mem_alloc(net->options.listen_count * sizeof *net->listeners);
    for (unsigned i = 0; i < net->options.listen_count; i++) {
        struct listener *listener = mem_alloc(sizeof *listener);
        *listener = (struct listener){.net = net, .fd = net->options.listen_fds[i]};
        net->listeners[i] = listener;
        uv_poll_init(net->studio->loop, &listener->poll, listener->fd);
        listener->poll.data = listener;
        uv_poll_start(&listener->poll, UV_READABLE, on_connection);
    }
}

static void on_closed(uv_handle_t *handle) {
    struct listener *listener = handle->data;
    close(listener->fd);
    free(listener);
}

void listeners_close(struct net *net) {
    for (unsigned i = 0; net->listeners && i < net->options.listen_count; i++)
        uv_close((uv_handle_t *)&net->listeners[i]->poll, on_closed);
    free(net->listeners);
    net->listeners = NULL;
}
