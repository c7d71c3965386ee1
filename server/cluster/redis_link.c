/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/buf.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/work/loop_idle.h"
#include "server/cluster/redis_internal.h"
#include <errno.h>
#include <hiredis/hiredis.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <utlist.h>
#include <uv.h>

enum { NUMBER_MOST = 65535 };

static int fail(struct error *e, const char *why) {
    return error_in_field(
        e, ERROR_BAD_FIELD, "--cluster",
        "%s: must be redis://[[USER]:PASSWORD@]HOST[:PORT][/NUMBER] or unix://[[USER]:PASSWORD@]/PATH", why);
}

/* Parses a number that consists of digits only. Returns -1 if it is not valid. */
static int number_of(const char *text, size_t size) {
    int number = 0;
    if (!size || size > 5)
        return -1;
    for (size_t i = 0; i < size; i++) {
        if (text[i] < '0' || text[i] > '9')
            return -1;
        number = number * 10 + text[i] - '0';
    }
    return number <= NUMBER_MOST ? number : -1;
}

/* Decodes percent-encoding. Returns NULL for a percent sign without two hexadecimal digits, or for an
 * encoded NUL. */
static char *decoded(const char *text, size_t size) {
    char *out = mem_alloc(size + 1), *to = out;
    for (size_t i = 0; i < size; i++) {
        char hex[3] = {0}, *end = hex;
        if (text[i] != '%') {
            *to++ = text[i];
            continue;
        }
        if (i + 2 < size)
            memcpy(hex, text + i + 1, 2);
        *to = (char)strtol(hex, &end, 16);
        if (end != hex + 2 || !*to++) {
            free(out);
            return NULL;
        }
        i += 2;
    }
    return out;
}

/* Reads "USER:PASSWORD", the part before the last @. */
static int read_login(const char *text, size_t size, struct redis_address *address, struct error *e) {
    const char *colon = memchr(text, ':', size);
    if (!colon)
        return fail(e, "a password must follow a colon");
    if (colon > text && !(address->user = decoded(text, (size_t)(colon - text))))
        return fail(e, "a percent sign that encodes nothing");
    address->password = decoded(colon + 1, size - (size_t)(colon + 1 - text));
    return address->password ? 0 : fail(e, "a percent sign that encodes nothing");
}

static int read_place(const char *at, struct redis_address *address, struct error *e) {
    const char *slash = strchr(at, '/'), *end = slash ? slash : at + strlen(at);
    const char *bracket = *at == '[' ? memchr(at, ']', (size_t)(end - at)) : NULL;
    const char *colon = memchr(bracket ? bracket : at, ':', (size_t)(end - (bracket ? bracket : at)));
    const char *name = bracket ? at + 1 : at, *name_end = bracket ? bracket : colon ? colon : end;
    if (name_end == name || (bracket && bracket + 1 != (colon ? colon : end)))
        return fail(e, "no host");
    address->host = mem_strndup(name, (size_t)(name_end - name));
    address->port = colon ? number_of(colon + 1, (size_t)(end - colon - 1)) : REDIS_PORT;
    if (address->port <= 0)
        return fail(e, "no such port");
    address->number = slash && slash[1] ? number_of(slash + 1, strlen(slash + 1)) : 0;
    return address->number < 0 ? fail(e, "invalid database number") : 0;
}

static void show(struct redis_address *address) {
    struct buf text = {0};
    if (address->path)
        buf_printf(&text, "%s", address->path);
    else
        buf_printf(&text, strchr(address->host, ':') ? "[%s]:%d" : "%s:%d", address->host, address->port);
    address->shown = mem_strndup((const char *)text.data, text.size);
    buf_free(&text);
}

int redis_address_read(const char *text, struct redis_address *address, struct error *e) {
    *address = (struct redis_address){0};
    bool file = !strncmp(text, "unix://", 7);
    if (!file && strncmp(text, "redis://", 8) != 0)
        return fail(e, "it has no address of Redis");
    const char *at = text + (file ? 7 : 8), *login_end = strrchr(at, '@');
    int status = login_end ? read_login(at, (size_t)(login_end - at), address, e) : 0;
    if (login_end)
        at = login_end + 1;
    if (!status && file && *at != '/')
        status = fail(e, "it has no socket path");
    else if (!status && file)
        address->path = mem_strdup(at);
    else if (!status)
        status = read_place(at, address, e);
    if (status)
        redis_address_free(address);
    else
        show(address);
    return status;
}

void redis_address_free(struct redis_address *address) {
    free(address->user);
    free(address->password);
    free(address->host);
    free(address->path);
    free(address->shown);
    *address = (struct redis_address){0};
}

/* ---- connections ---- */

/* A connection to a Redis server on a libuv loop. hiredis only parses the replies. Its asynchronous interface
 * asserts that a server sends no unrequested replies, so a server could abort the daemon. Each reply goes to
 * the oldest pending command; a reply without one, or one that reply_check.h rejects, closes the connection.
 *
 * The socket is polled for input all the time, and output is written together at the end of the loop's turn.
 * An adapter that changes the polled events at each command makes libuv forget that the socket is readable,
 * so a loop with output in every turn would never read an answer. */

struct redis_loop;
struct link_text;

struct redis_loop_events {
    void (*connected)(void *ctx);
    void (*lost)(void *ctx, const char *why); /* called once; the owner must close the connection then */
};

/* Measures how long a server has been silent, in a loop that checks only periodically. */

struct silence {
    uint64_t ms;        /* since the last answer, or since the first command without one */
    uint64_t looked_at; /* loop time */
};

static inline void silence_begin(struct silence *silence, uint64_t now) {
    *silence = (struct silence){.looked_at = now};
}

/* A loop that was busy, or a process that got no CPU time, has not checked meanwhile. However long the gap
 * was, it counts as at most `most` ms, so the loop reads pending data before it judges. */
static inline void silence_count(struct silence *silence, uint64_t now, uint64_t most) {
    uint64_t since = now - silence->looked_at;
    silence->ms += since < most ? since : most;
    silence->looked_at = now;
}

enum { READ_BYTES = 65536 };

/* A command that awaits its answer. */
struct loop_question {
    void (*answered)(void *ctx, const redisReply *reply);
    void *ctx;
    struct loop_question *next;
};

struct redis_loop {
    uv_poll_t poll;
    struct loop_idle *end; /* armed while there is output for the end of the loop's turn */
    struct redis_loop_events events;
    void *ctx;
    int fd, polled;
    bool connected, lost, closed;
    struct reply_check check;
    redisReader *reader;
    struct buf unsent;
    struct loop_question *questions, *last; /* oldest first */
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

/* Reports the connection as lost. Nothing is read or written from here on. */
static void lose(struct redis_loop *l, const char *why) {
    if (l->lost || l->closed)
        return;
    l->lost = true;
    loop_idle_wait(l->end, false);
    uv_poll_stop(&l->poll);
    l->events.lost(l->ctx, why);
}

static void answer(struct redis_loop *l, const redisReply *reply) {
    struct loop_question *q = l->questions;
    if (!q && l->heard) {
        l->heard(l->heard_ctx, reply);
    } else if (!q) {
        char why[128];
        snprintf(why, sizeof why, "%s",
                 reply->type == REDIS_REPLY_ERROR ? reply->str : "it sent an unexpected reply");
        lose(l, why);
    } else {
        LL_DELETE(l->questions, q);
        if (q->answered)
            q->answered(q->ctx, reply);
        free(q);
    }
}

/* A callback may close the connection; the reader is freed later (on_closed). */
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

/* status < 0: libuv has stopped polling; reading shows the cause. */
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

/* Writes what the kernel accepts; the rest follows when the socket is writable. */
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

/* Returns NULL with errno set. */
static struct redis_loop *redis_loop_open(uv_loop_t *loop, const struct sockaddr *to, socklen_t size,
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
    poll_for(l, UV_WRITABLE); /* writable means connected */
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

/* Sends a command. answered may be NULL; its reply is valid until it returns, and NULL when the connection
 * is closed first. */
static void redis_loop_ask(struct redis_loop *l, const struct link_text *words, int count,
                           void (*answered)(void *ctx, const redisReply *reply), void *ctx) {
    struct loop_question *q = mem_alloc(sizeof *q);
    *q = (struct loop_question){answered, ctx, NULL};
    if (l->questions)
        l->last->next = q;
    else
        l->questions = q;
    l->last = q;
    write_command(l, words, count);
}

/* Sends a command whose replies keep coming; all go to heard. */
static void redis_loop_hear(struct redis_loop *l, const struct link_text *words, int count,
                            void (*heard)(void *ctx, const redisReply *reply), void *ctx) {
    l->heard = heard;
    l->heard_ctx = ctx;
    write_command(l, words, count);
}

/* Writes pending output now, as far as the kernel accepts it. This may lose the connection. */
static void redis_loop_flush(struct redis_loop *l) {
    write_unsent(l);
}

static void on_closed(uv_handle_t *poll) {
    struct redis_loop *l = poll->data;
    redisReaderFree(l->reader);
    buf_free(&l->unsent);
    free(l);
}

/* Closes the connection; pending commands get NULL. */
static void redis_loop_close(struct redis_loop *l) {
    l->closed = true;
    loop_idle_close(l->end);
    uv_close((uv_handle_t *)&l->poll, on_closed);
    close(l->fd);
    while (l->questions) {
        struct loop_question *q = l->questions;
        LL_DELETE(l->questions, q);
        if (q->answered)
            q->answered(q->ctx, NULL);
        free(q);
    }
}

struct redis_link {
    uv_loop_t *loop;
    struct redis_address address;
    struct redis_loop *redis; /* NULL: not connected */
    uv_getaddrinfo_t look_up;
    uv_timer_t pulse;
    uint64_t again, again_in; /* loop time of the next attempt; delay of the one after it, ms */
    struct silence silence;
    unsigned unanswered;
    bool overdue; /* timed out once already: pending data may not have been read yet */
    bool up, told, looking_up, closing;
    void (*changed)(void *ctx, bool up);
    void *ctx;
    char *channel; /* channel it subscribes to; NULL: it sends commands */
    void (*heard)(void *ctx, const void *data, size_t size);
    void *heard_ctx;
};

/* A command that awaits its answer. */
struct question {
    struct redis_link *link;
    link_answered answered;
    void *ctx;
};

static void lost(struct redis_link *link, const char *why) {
    bool was_up = link->up;
    link->up = false;
    link->unanswered = 0;
    link->again = uv_now(link->loop) + link->again_in;
    link->again_in = link->again_in * 2 < LINK_AGAIN_MOST_MS ? link->again_in * 2 : LINK_AGAIN_MOST_MS;
    if (link->closing)
        return;
    if (!link->told)
        log_warn("cluster: %s: %s; continuing without the cluster", link->address.shown, why);
    link->told = true;
    if (was_up)
        link->changed(link->ctx, false);
}

/* Closes the connection. Callbacks called meanwhile find the link down. */
static void drop(struct redis_link *link, const char *why) {
    struct redis_loop *redis = link->redis;
    link->redis = NULL;
    if (redis)
        redis_loop_close(redis);
    lost(link, why);
}

static void on_lost(void *ctx, const char *why) {
    drop(ctx, why);
}

static void on_answer(void *ctx, const redisReply *reply) {
    struct question *q = ctx;
    struct redis_link *link = q->link;
    if (reply) {
        silence_begin(&link->silence, uv_now(link->loop));
        link->unanswered -= link->unanswered > 0;
        link->overdue = false;
    }
    if (q->answered)
        q->answered(q->ctx, reply);
    free(q);
}

static bool ask(struct redis_link *link, const struct link_text *words, int count, link_answered answered,
                void *ctx) {
    if (!link->redis)
        return false;
    struct question *q = mem_alloc(sizeof *q);
    *q = (struct question){link, answered, ctx};
    redis_loop_ask(link->redis, words, count, on_answer, q);
    if (!link->unanswered++)
        silence_begin(&link->silence, uv_now(link->loop));
    return true;
}

bool redis_link_send(struct redis_link *link, const struct link_text *words, int count,
                     link_answered answered, void *ctx) {
    return link->up && ask(link, words, count, answered, ctx);
}

void redis_link_flush(struct redis_link *link) {
    if (redis_link_up(link))
        redis_loop_flush(link->redis);
}

/* False while a lost link is ending its pending commands. */
bool redis_link_up(const struct redis_link *link) {
    return link->up && link->redis;
}

/* Handles the replies to AUTH and SELECT: an error is logged, and the connection is tried again. */
static void on_greeted(void *ctx, const redisReply *reply) {
    struct redis_link *link = ctx;
    if (reply && reply->type == REDIS_REPLY_ERROR)
        drop(link, reply->str);
}

static void come_up(struct redis_link *link) {
    link->up = true;
    link->again_in = LINK_AGAIN_MS;
    if (link->told || !link->channel)
        log_info("cluster: %s answers", link->address.shown);
    link->told = false;
    link->changed(link->ctx, true);
}

static bool is_word(const redisReply *reply, const char *word) {
    return reply->type == REDIS_REPLY_STRING && !strcmp(reply->str, word);
}

/* Handles the confirmation of a subscription, and messages. */
static void on_channel(void *ctx, const redisReply *reply) {
    struct redis_link *link = ctx;
    bool well =
        reply->type == REDIS_REPLY_ARRAY && reply->elements == 3 && is_word(reply->element[1], link->channel);
    bool message =
        well && is_word(reply->element[0], "message") && reply->element[2]->type == REDIS_REPLY_STRING;
    if (!message && !(well && is_word(reply->element[0], "subscribe"))) {
        drop(link, reply->type == REDIS_REPLY_ERROR ? reply->str : "it sent an invalid channel message");
        return;
    }
    silence_begin(&link->silence, uv_now(link->loop));
    link->unanswered = 0;
    link->overdue = false;
    if (message)
        link->heard(link->heard_ctx, reply->element[2]->str, (size_t)reply->element[2]->len);
    else if (!link->up)
        come_up(link);
}

/* Subscribes. Subscribing again also serves as a ping: it is answered, unlike other commands on such a
 * connection. */
static void hear(struct redis_link *link) {
    redis_loop_hear(link->redis, (struct link_text[]){link_text_of("SUBSCRIBE"), link_text_of(link->channel)},
                    2, on_channel, link);
    if (!link->unanswered++)
        silence_begin(&link->silence, uv_now(link->loop));
}

static void on_first_pong(void *ctx, const redisReply *reply) {
    struct redis_link *link = ctx;
    on_greeted(ctx, reply);
    if (!reply || reply->type == REDIS_REPLY_ERROR || !link->redis)
        return;
    if (link->channel)
        hear(link);
    else
        come_up(link);
}

static void on_connected(void *ctx) {
    struct redis_link *link = ctx;
    const struct redis_address *a = &link->address;
    char number[16];
    link->unanswered = 0;
    if (a->password && a->user)
        ask(link,
            (struct link_text[]){link_text_of("AUTH"), link_text_of(a->user), link_text_of(a->password)}, 3,
            on_greeted, link);
    else if (a->password)
        ask(link, (struct link_text[]){link_text_of("AUTH"), link_text_of(a->password)}, 2, on_greeted, link);
    snprintf(number, sizeof number, "%d", a->number);
    if (a->number)
        ask(link, (struct link_text[]){link_text_of("SELECT"), link_text_of(number)}, 2, on_greeted, link);
    ask(link, (struct link_text[]){link_text_of("PING")}, 1, on_first_pong, link);
}

static void begin_at(struct redis_link *link, const struct sockaddr *to, socklen_t size) {
    static const struct redis_loop_events events = {on_connected, on_lost};
    link->redis = redis_loop_open(link->loop, to, size, &events, link);
    if (!link->redis) {
        lost(link, strerror(errno));
        return;
    }
    link->unanswered = 1;
    silence_begin(&link->silence, uv_now(link->loop));
}

static void begin_unix(struct redis_link *link) {
    struct sockaddr_un to = {.sun_family = AF_UNIX};
    if (strlen(link->address.path) >= sizeof to.sun_path) {
        lost(link, "the path of its socket is too long");
        return;
    }
    strcpy(to.sun_path, link->address.path);
    begin_at(link, (struct sockaddr *)&to, sizeof to);
}

static void begin_inet(struct redis_link *link, const struct addrinfo *found) {
    struct sockaddr_storage to = {0};
    memcpy(&to, found->ai_addr, found->ai_addrlen);
    in_port_t port = htons((uint16_t)link->address.port);
    if (to.ss_family == AF_INET6)
        ((struct sockaddr_in6 *)&to)->sin6_port = port;
    else
        ((struct sockaddr_in *)&to)->sin_port = port;
    begin_at(link, (struct sockaddr *)&to, found->ai_addrlen);
}

static void free_if_closed(struct redis_link *link) {
    if (link->looking_up || link->loop)
        return;
    redis_address_free(&link->address);
    free(link->channel);
    free(link);
}

static void on_found(uv_getaddrinfo_t *look_up, int status, struct addrinfo *found) {
    struct redis_link *link = look_up->data;
    link->looking_up = false;
    if (!link->closing && !status)
        begin_inet(link, found);
    else if (!link->closing)
        lost(link, uv_strerror(status));
    uv_freeaddrinfo(found);
    free_if_closed(link);
}

static void begin(struct redis_link *link) {
    static const struct addrinfo hints = {.ai_socktype = SOCK_STREAM};
    if (link->address.path) {
        begin_unix(link);
        return;
    }
    link->look_up.data = link;
    link->looking_up =
        !uv_getaddrinfo(link->loop, &link->look_up, on_found, link->address.host, NULL, &hints);
    if (!link->looking_up)
        lost(link, "its name cannot be resolved");
}

static void on_pulse(uv_timer_t *timer) {
    struct redis_link *link = timer->data;
    silence_count(&link->silence, uv_now(link->loop), LINK_PULSE_MS);
    if (!link->redis) {
        if (!link->looking_up && uv_now(link->loop) >= link->again)
            begin(link);
    } else if (link->unanswered && link->silence.ms >= LINK_PATIENCE_MS) {
        if (link->overdue)
            drop(link, "it does not answer");
        link->overdue = !link->overdue;
    } else if (link->up && !link->unanswered && link->silence.ms >= LINK_PATIENCE_MS) {
        if (link->channel)
            hear(link);
        else
            ask(link, (struct link_text[]){link_text_of("PING")}, 1, NULL, NULL);
    }
}

struct redis_link *redis_link_open(uv_loop_t *loop, struct redis_address *address,
                                   void (*changed)(void *ctx, bool up), void *ctx) {
    struct redis_link *link = mem_alloc(sizeof *link);
    *link = (struct redis_link){
        .loop = loop, .address = *address, .again_in = LINK_AGAIN_MS, .changed = changed, .ctx = ctx};
    *address = (struct redis_address){0};
    uv_timer_init(loop, &link->pulse);
    link->pulse.data = link;
    uv_timer_start(&link->pulse, on_pulse, 0, LINK_PULSE_MS);
    return link;
}

void redis_link_hear(struct redis_link *link, const char *channel,
                     void (*heard)(void *ctx, const void *data, size_t size), void *ctx) {
    link->channel = mem_strdup(channel);
    link->heard = heard;
    link->heard_ctx = ctx;
}

static void on_pulse_closed(uv_handle_t *handle) {
    struct redis_link *link = handle->data;
    link->loop = NULL;
    free_if_closed(link);
}

void redis_link_close(struct redis_link *link) {
    link->closing = true;
    drop(link, "closed");
    if (link->looking_up)
        uv_cancel((uv_req_t *)&link->look_up);
    uv_close((uv_handle_t *)&link->pulse, on_pulse_closed);
}
