/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens what is listened on: an address of the machine, or sockets that were passed to us. */
#include "server/base/mem.h"
#include "server/net/listen_address.h"
#include "server/net/listener_internal.h"
#include "server/net/net_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BIND_TRIES = 20 }; /* for a free port that is free in all addresses */

static int bind_to(struct listen_address *a, int port) {
    int fd = socket(a->at.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0), yes = 1;
    if (fd < 0)
        return -1;
    listen_address_set_port(&a->at, port);
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (a->at.ss_family == AF_INET6) /* IPv4 is another address */
        setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &yes, sizeof yes);
    if (bind(fd, (struct sockaddr *)&a->at, a->size) || listen(fd, SOMAXCONN)) {
        int why = errno;
        close(fd);
        errno = why;
        return -1;
    }
    return fd;
}

static void add(struct listeners *all, int fd) {
    struct listener *l = mem_alloc(sizeof *l);
    socklen_t size = sizeof l->at;
    *l = (struct listener){.all = all, .fd = fd};
    getsockname(fd, (struct sockaddr *)&l->at, &size);
    all->list = mem_grow(all->list, &all->cap, all->count + 1, sizeof *all->list);
    all->list[all->count++] = l;
}

void listener_sockets_drop(struct listeners *all) {
    while (all->count) {
        close(all->list[--all->count]->fd);
        free(all->list[all->count]);
    }
}

/* In all addresses, at one port. An address of a family that the machine does not have may be missing when
 * there is another. -1: errno says why. */
static int bind_all(struct listeners *all, struct listen_addresses *found, int port) {
    int why = EADDRNOTAVAIL;
    for (size_t i = 0; i < found->count; i++) {
        int fd = bind_to(&found->list[i], all->count ? listen_address_port(&all->list[0]->at) : port);
        if (fd >= 0) {
            add(all, fd);
            continue;
        }
        why = errno;
        if (why != EADDRNOTAVAIL && why != EAFNOSUPPORT) {
            listener_sockets_drop(all);
            break;
        }
    }
    errno = why;
    return all->count ? 0 : -1;
}

static int bind_host(struct listeners *all, struct listen_addresses *found, struct error *e) {
    const struct net_options *o = &all->net->options;
    int failed = -1;
    for (int i = 0; failed && i < (o->port ? 1 : BIND_TRIES); i++) {
        failed = bind_all(all, found, o->port);
        if (errno != EADDRINUSE)
            break;
    }
    if (failed)
        return error_set(e, ERROR_CANNOT_LISTEN, "cannot listen on %s port %d: %s", o->host, o->port,
                         strerror(errno));
    return 0;
}

/* Somebody else (systemd) has opened them, and listens on them. */
static int take_passed(struct listeners *all, struct error *e) {
    const struct net_options *o = &all->net->options;
    for (unsigned i = 0; i < o->listen_count; i++) {
        int fd = o->listen_fds[i], listens = 0;
        socklen_t size = sizeof listens;
        if (getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) || !listens)
            return error_set(e, ERROR_CANNOT_LISTEN,
                             "descriptor %d, which was passed, is no socket that listens", fd);
        fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK);
        fcntl(fd, F_SETFD, FD_CLOEXEC);
        add(all, fd);
    }
    return 0;
}

/* May what others can reach be listened on? */
static int check(const struct net *net, bool local, const char *what, struct error *e) {
    const struct net_options *o = &net->options;
    if (local || (o->remote && o->secrets))
        return 0;
    if (!o->remote)
        return error_in_field(
            e, ERROR_BAD_FIELD, "host",
            "'%s' is not a loopback address; to be heard by other machines, say so with --remote", what);
    return error_in_field(e, ERROR_BAD_FIELD, "host",
                          "'%s' can be reached by other machines: tokens are needed, so name a --secret-file",
                          what);
}

static int check_passed(const struct listeners *all, struct error *e) {
    int failed = 0;
    for (size_t i = 0; i < all->count && !failed; i++) {
        struct buf text = {0};
        listen_address_write(&all->list[i]->at, false, &text);
        failed = check(all->net, listen_address_is_local(&all->list[i]->at), (const char *)text.data, e);
        buf_free(&text);
    }
    return failed;
}

static int open_host(struct listeners *all, struct error *e) {
    struct listen_addresses found;
    listen_addresses_find(&found, all->net->options.host);
    bool local = found.count > 0;
    for (size_t i = 0; i < found.count; i++)
        local &= listen_address_is_local(&found.list[i].at);
    int failed = check(all->net, local, all->net->options.host, e) || bind_host(all, &found, e);
    free(found.list);
    return failed;
}

int listener_sockets_open(struct listeners *all, struct error *e) {
    int failed =
        all->net->options.listen_count ? take_passed(all, e) || check_passed(all, e) : open_host(all, e);
    if (failed)
        listener_sockets_drop(all);
    return failed ? -1 : 0;
}
