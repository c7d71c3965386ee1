/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_loop.h"
#include "server/base/buf.h"
#include "server/base/loop_idle.h"
#include "server/base/mem.h"
#include "server/cluster/redis_link.h"
#include "server/cluster/reply_check.h"
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <unistd.h>
#include <utlist.h>

enum { READ_BYTES = 65536 };

/* A command whose answer is waited for. */
struct question {
    void (*answered)(void *ctx, const redisReply *reply);
    void *ctx;
    struct question *next;
};

struct redis_loop {
    uv_poll_t poll;
    struct loop_idle *end; /* waits while something is to be written then */
    struct redis_loop_events events;
    void *ctx;
    int fd, polled;
    bool connected, lost, closed;
    struct reply_check check;
    redisReader *reader;
    struct buf unsent;
    struct question *questions, *last; /* the oldest first */
    void (*heard)(void *ctx, const redisReply *reply);
    void *heard_ctx;
};

static void on_poll(uv_poll_t *poll, int status, int events);

static void poll_for(struct redis_loop *l, int events) {
    if (l->polled == events || l->closed)
        return;
    l->polled = events;
    uv_poll_start(&l->poll, events, on_poll);
}

/* From here on nothing is read or written. */
static void lose(struct redis_loop *l, const char *why) {
    if (l->lost || l->closed)
        return;
    l->lost = true;
    loop_idle_wait(l->end, false);
    uv_poll_stop(&l->poll);
    l->events.lost(l->ctx, why);
}

static void answer(struct redis_loop *l, const redisReply *reply) {
    struct question *q = l->questions;
    if (!q && l->heard) {
        l->heard(l->heard_ctx, reply);
    } else if (!q) {
        char why[128];
        snprintf(why, sizeof why, "%s",
                 reply->type == REDIS_REPLY_ERROR ? reply->str : "it sends what nobody has asked for");
        lose(l, why);
    } else {
        LL_DELETE(l->questions, q);
        if (q->answered)
            q->answered(q->ctx, reply);
        free(q);
    }
}

/* What answers may close the connection; its reader is freed later (on_closed). */
static void read_replies(struct redis_loop *l) {
    void *reply = NULL;
    while (!l->lost && !l->closed) {
        if (redisReaderGetReply(l->reader, &reply) != REDIS_OK) {
            lose(l, redisReaderGetError(l->reader));
            return;
        }
        if (!reply)
            return;
        answer(l, reply);
        freeReplyObject(reply);
    }
}

static void take(struct redis_loop *l) {
    char bytes[READ_BYTES];
    ssize_t size = recv(l->fd, bytes, sizeof bytes, MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR))
        return;
    const char *why = size < 0    ? strerror(errno)
                      : size == 0 ? "the connection was closed"
                                  : reply_check(&l->check, bytes, (size_t)size);
    if (!why && redisReaderFeed(l->reader, bytes, (size_t)size) != REDIS_OK)
        why = redisReaderGetError(l->reader);
    if (why)
        lose(l, why);
    else
        read_replies(l);
}

static void write_unsent(struct redis_loop *l) {
    if (!l->connected || l->lost || l->closed)
        return;
    ssize_t size =
        l->unsent.size ? send(l->fd, l->unsent.data, l->unsent.size, MSG_DONTWAIT | MSG_NOSIGNAL) : 0;
    if (size < 0 && errno != EAGAIN && errno != EINTR) {
        lose(l, strerror(errno));
        return;
    }
    if (size > 0)
        buf_consume(&l->unsent, (size_t)size);
    loop_idle_wait(l->end, false);
    poll_for(l, UV_READABLE | (l->unsent.size ? UV_WRITABLE : 0));
}

static void finish_connecting(struct redis_loop *l) {
    int why = 0;
    socklen_t size = sizeof why;
    if (getsockopt(l->fd, SOL_SOCKET, SO_ERROR, &why, &size) || why) {
        lose(l, strerror(why ? why : errno));
        return;
    }
    l->connected = true;
    l->events.connected(l->ctx);
    write_unsent(l);
}

/* status < 0: libuv has stopped polling; reading shows what is wrong. */
static void on_poll(uv_poll_t *poll, int status, int events) {
    struct redis_loop *l = poll->data;
    if (!l->connected) {
        if (status < 0 || events & UV_WRITABLE)
            finish_connecting(l);
        return;
    }
    if (status < 0 || events & UV_READABLE)
        take(l);
    if (status < 0)
        lose(l, uv_strerror(status));
    else if (events & UV_WRITABLE)
        write_unsent(l);
}

/* What the system does not take now leaves when it can. */
static void write_now(void *data) {
    write_unsent(data);
}

static int connect_to(const struct sockaddr *to, socklen_t size) {
    int yes = 1, fd = socket(to->sa_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return -1;
    if (to->sa_family != AF_UNIX)
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    if (!connect(fd, to, size) || errno == EINPROGRESS)
        return fd;
    int why = errno;
    close(fd);
    errno = why;
    return -1;
}

struct redis_loop *redis_loop_open(uv_loop_t *loop, const struct sockaddr *to, socklen_t size,
                                   const struct redis_loop_events *events, void *ctx) {
    int fd = connect_to(to, size);
    if (fd < 0)
        return NULL;
    struct redis_loop *l = mem_alloc(sizeof *l);
    *l = (struct redis_loop){.fd = fd, .events = *events, .ctx = ctx, .reader = redisReaderCreate()};
    int failed = l->reader ? uv_poll_init(loop, &l->poll, fd) : UV_ENOMEM;
    if (failed) {
        if (l->reader)
            redisReaderFree(l->reader);
        close(fd);
        free(l);
        errno = -failed;
        return NULL;
    }
    l->poll.data = l;
    l->end = loop_idle_open(loop, write_now, l);
    poll_for(l, UV_WRITABLE); /* it is when it is connected */
    return l;
}

static void write_command(struct redis_loop *l, const struct link_text *words, int count) {
    buf_printf(&l->unsent, "*%d\r\n", count);
    for (int i = 0; i < count; i++) {
        buf_printf(&l->unsent, "$%zu\r\n", words[i].size);
        buf_add(&l->unsent, words[i].data, words[i].size);
        buf_add(&l->unsent, "\r\n", 2);
    }
    if (l->connected && !(l->polled & UV_WRITABLE))
        loop_idle_wait(l->end, true);
}

void redis_loop_ask(struct redis_loop *l, const struct link_text *words, int count,
                    void (*answered)(void *ctx, const redisReply *reply), void *ctx) {
    struct question *q = mem_alloc(sizeof *q);
    *q = (struct question){answered, ctx, NULL};
    if (l->questions)
        l->last->next = q;
    else
        l->questions = q;
    l->last = q;
    write_command(l, words, count);
}

void redis_loop_hear(struct redis_loop *l, const struct link_text *words, int count,
                     void (*heard)(void *ctx, const redisReply *reply), void *ctx) {
    l->heard = heard;
    l->heard_ctx = ctx;
    write_command(l, words, count);
}

void redis_loop_flush(struct redis_loop *l) {
    write_unsent(l);
}

static void on_closed(uv_handle_t *poll) {
    struct redis_loop *l = poll->data;
    redisReaderFree(l->reader);
    buf_free(&l->unsent);
    free(l);
}

void redis_loop_close(struct redis_loop *l) {
    l->closed = true;
    loop_idle_close(l->end);
    uv_close((uv_handle_t *)&l->poll, on_closed);
    close(l->fd);
    while (l->questions) {
        struct question *q = l->questions;
        LL_DELETE(l->questions, q);
        if (q->answered)
            q->answered(q->ctx, NULL);
        free(q);
    }
}
