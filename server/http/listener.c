/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Listens on an address of the machine or on passed sockets, and accepts connections within the limits. */
#include "server/access/quota.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/metrics.h"
#include "server/http/http_internal.h"
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    BIND_TRIES = 20,    /* to find a port that is free on all addresses */
    ACCEPTS = 64,       /* per callback */
    BORROWED_MS = 1000, /* time limit of a connection on a reserve descriptor */
    CROWD = 8,          /* connections above the limit of an address that are still told so */
    RESERVE = 4,        /* descriptors kept to report to clients that the others are used up */
};

struct listener {
    struct listeners *all;
    struct sockaddr_storage at;
    int fd;
    uv_poll_t poll;
};

struct listeners {
    struct http_server *server;
    struct listener **list;
    size_t count, cap;
    int reserve[RESERVE];
    unsigned reserved;
    bool paused;
    uint64_t complained; /* loop time, ms */
};

static int bind_to(struct listen_address *a, int port) {
    int fd = socket(a->at.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0), yes = 1;
    if (fd < 0)
        return -1;
    listen_address_set_port(&a->at, port);
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (a->at.ss_family == AF_INET6) /* a separate socket listens on IPv4 */
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

static void sockets_drop(struct listeners *all) {
    while (all->count) {
        close(all->list[--all->count]->fd);
        free(all->list[all->count]);
    }
}

/* Binds all addresses to one port. Skips an address whose family the machine lacks, as long as another
 * works. -1: errno tells why. */
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
            sockets_drop(all);
            break;
        }
    }
    errno = why;
    return all->count ? 0 : -1;
}

static int bind_host(struct listeners *all, struct listen_addresses *found, struct error *e) {
    const struct http_options *o = &all->server->options;
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

/* Takes sockets that another process (systemd) opened and listens on. */
static int take_passed(struct listeners *all, struct error *e) {
    const struct http_options *o = &all->server->options;
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

/* Checks whether listening on an address that other machines can reach is allowed. */
static int check(const struct http_server *server, bool local, const char *what, struct error *e) {
    const struct http_options *o = &server->options;
    if (local || (o->remote && o->tokens))
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
        failed = check(all->server, listen_address_is_local(&all->list[i]->at), (const char *)text.data, e);
        buf_free(&text);
    }
    return failed;
}

static int open_host(struct listeners *all, struct error *e) {
    struct listen_addresses found;
    listen_addresses_find(&found, all->server->options.host);
    bool local = found.count > 0;
    for (size_t i = 0; i < found.count; i++)
        local &= listen_address_is_local(&found.list[i].at);
    int failed = check(all->server, local, all->server->options.host, e) || bind_host(all, &found, e);
    free(found.list);
    return failed;
}

static int sockets_open(struct listeners *all, struct error *e) {
    int failed =
        all->server->options.listen_count ? take_passed(all, e) || check_passed(all, e) : open_host(all, e);
    if (failed)
        sockets_drop(all);
    return failed ? -1 : 0;
}

static void on_connection(uv_poll_t *poll, int status, int events);

static void pause_all(struct listeners *all, bool paused) {
    if (all->paused == paused)
        return;
    all->paused = paused;
    for (size_t i = 0; i < all->count; i++)
        if (paused)
            uv_poll_stop(&all->list[i]->poll);
        else
            uv_poll_start(&all->list[i]->poll, UV_READABLE, on_connection);
}

static void fill_reserve(struct listeners *all) {
    while (all->reserved < RESERVE) {
        int fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
        if (fd < 0)
            return;
        all->reserve[all->reserved++] = fd;
    }
}

/* Closes an idle connection to make room. Returns false if there is none. */
static bool make_room(struct http_server *server) {
    struct connection *oldest = NULL;
    for (struct connection *c = server->open; c; c = c->next)
        if (c->http && !c->closing && http_session_is_idle(c))
            oldest = c;
    if (oldest)
        connection_close(oldest);
    return oldest != NULL;
}

/* Closes a connection far above the limits without allocating anything for it, which frees its descriptor
 * at once. */
static bool turned_away(struct http_server *server, int fd, bool borrowed) {
    if (server->connections < server->options.connections + server->options.connections_above)
        return false;
    metrics_add(server->metrics, METRIC_REFUSED_LIMIT, 1);
    close(fd);
    listeners_freed(server, borrowed);
    return true;
}

static void take(struct http_server *server, int fd, const struct sockaddr_storage *peer, bool borrowed) {
    if (turned_away(server, fd, borrowed))
        return;
    struct connection *c = connection_open(server, fd, peer);
    http_session_open(c);
    const struct http_options *o = &server->options;
    unsigned here = quota_open(server->quota, c->key);
    c->crowded = o->address_connections && here > o->address_connections;
    c->surplus = borrowed || (server->connections > o->connections && !make_room(server));
    c->borrows_reserve = borrowed;
    if (borrowed)
        c->end_by = connection_now(c) + BORROWED_MS;
    if (c->crowded && here > o->address_connections + CROWD) {
        metrics_add(server->metrics, METRIC_REFUSED_LIMIT, 1);
        connection_close(c);
    }
}

static void complain(struct listeners *all, int why) {
    uint64_t now = uv_now(all->server->loop);
    if (all->complained && now - all->complained < 1000)
        return;
    all->complained = now;
    log_warn("no connection can be taken: %s; %u are open", strerror(why), all->server->connections);
}

static int accept_from(const struct listener *l, struct sockaddr_storage *peer) {
    socklen_t size = sizeof *peer;
    *peer = (struct sockaddr_storage){0};
    int fd = accept4(l->fd, (struct sockaddr *)peer, &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd >= 0 && size <= sizeof(sa_family_t))
        peer->ss_family = AF_UNIX; /* an unnamed peer */
    return fd;
}

/* Out of descriptors: a few clients are accepted on reserve descriptors and told so. After that, accepting
 * pauses until a descriptor is free. */
static void when_full(struct listener *l, int why) {
    struct listeners *all = l->all;
    struct sockaddr_storage peer;
    complain(all, why);
    if (all->reserved) {
        close(all->reserve[--all->reserved]);
        int fd = accept_from(l, &peer);
        if (fd >= 0)
            take(all->server, fd, &peer, true);
        else
            fill_reserve(all);
    }
    if (!all->reserved)
        pause_all(all, true);
}

static void on_connection(uv_poll_t *poll, int status, int events) {
    struct listener *l = poll->data;
    struct sockaddr_storage peer;
    (void)events;
    for (int i = 0; i < ACCEPTS && !status && !l->all->paused; i++) {
        int fd = accept_from(l, &peer);
        if (fd >= 0)
            take(l->all->server, fd, &peer, false);
        else if (errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS)
            when_full(l, errno);
        else if (errno == EAGAIN)
            return;
    }
}

void listeners_freed(struct http_server *server, bool reserve) {
    struct listeners *all = server->listeners;
    if (!all || (!reserve && !all->paused && all->reserved == RESERVE))
        return;
    fill_reserve(all);
    if (all->reserved)
        pause_all(all, false);
}

void listeners_look(struct http_server *server) {
    listeners_freed(server, true);
}

static bool are_local(const struct listeners *all) {
    bool local = true;
    for (size_t i = 0; local && i < all->count; i++)
        local = listen_address_is_local(&all->list[i]->at);
    return local;
}

int listeners_open(struct http_server *server, struct error *e) {
    struct listeners *all = mem_alloc(sizeof *all);
    all->server = server;
    if (sockets_open(all, e)) {
        free(all->list);
        free(all);
        return -1;
    }
    for (size_t i = 0; i < all->count; i++) {
        uv_poll_init(server->loop, &all->list[i]->poll, all->list[i]->fd);
        all->list[i]->poll.data = all->list[i];
    }
    fill_reserve(all);
    all->paused = true;
    pause_all(all, false);
    server->listeners = all;
    server->local = are_local(all);
    return 0;
}

static void on_closed(uv_handle_t *handle) {
    struct listener *l = handle->data;
    close(l->fd);
    free(l);
}

void listeners_close(struct http_server *server) {
    struct listeners *all = server->listeners;
    if (!all)
        return;
    server->listeners = NULL;
    for (size_t i = 0; i < all->count; i++)
        uv_close((uv_handle_t *)&all->list[i]->poll, on_closed);
    while (all->reserved)
        close(all->reserve[--all->reserved]);
    free(all->list);
    free(all);
}

bool listeners_address(const struct http_server *server, size_t number, struct buf *out) {
    if (!server->listeners || number >= server->listeners->count)
        return false;
    listen_address_write(&server->listeners->list[number]->at, server->options.tls != NULL, out);
    return true;
}

bool listeners_outside_address(const struct http_server *server, size_t number, struct buf *out) {
    struct listen_addresses found = {0};
    for (size_t i = 0; server->listeners && i < server->listeners->count; i++)
        listen_addresses_outside(&found, &server->listeners->list[i]->at);
    bool there = number < found.count;
    if (there)
        listen_address_write(&found.list[number].at, server->options.tls != NULL, out);
    free(found.list);
    return there;
}
