/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/http/websocket.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/base/metrics.h"
#include "server/http/http_internal.h"
#include <ctype.h>
#include <openssl/evp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_CHARS = 24,
    ACCEPT_CHARS = 28,
    MESSAGE_TIMES = 16, /* a message this many times the limit ends the connection */
    HEAD_BYTES = 512,   /* kept of a message that is too long */
    SEND_TOGETHER = 32, /* most messages per write */
    HANG_UP_MS = 25000, /* clients wait half a minute for the reply to their close */
    GOODBYE_MS = 2000,  /* for the client to answer our close */
};

struct websocket {
    struct connection *connection;
    const struct websocket_calls *calls;
    void *owner;
    struct websocket_reader reader;
    struct buf message; /* being received */
    bool too_long;      /* the rest of it is dropped */
    struct message_queue queue;
    struct queued_message *leaving;                   /* partly sent message */
    size_t left_at;                                   /* bytes of its frame already sent */
    struct queued_message *pong;                      /* queued answer to the last ping */
    uint64_t last_rx;                                 /* loop time when the client last sent bytes, ms */
    enum { PROBE_NONE, PROBE_DUE, PROBE_SENT } probe; /* the ping that checks whether the client is alive */
    bool rx_paused;                                   /* reading is off until the client takes bytes again */
    bool held; /* by the owner: reading is off, and received bytes wait in `unread` */
    struct buf unread;
    const char *close_reason; /* why the connection is to be closed */
    enum websocket_status close_status;
    enum websocket_status hangs_up; /* status of the client's close, which is answered later */
    uint64_t hang_up_by;            /* loop time of the latest answer, ms; 0: the client has not closed */
    bool farewell; /* the client has closed or violated the protocol: nothing more is expected from it */
    bool closing;  /* the close frame is being sent, or was sent */
    bool sending;  /* go_on is running */
};

static void go_on(struct websocket *ws);

/* Loop time, ms. */
static uint64_t websocket_now(const struct websocket *ws) {
    return connection_now(ws->connection);
}

/* Closes now, because the client has closed or violated the protocol. */
static void bid_farewell(struct websocket *ws, enum websocket_status status, const char *reason) {
    ws->farewell = true;
    if (ws->closing) {
        go_on(ws);
        return;
    }
    ws->close_reason = NULL;
    websocket_close(ws, status, reason);
}

/* Resumes reading unless it is paused or held. */
static void listen_again(struct websocket *ws) {
    connection_read(ws->connection, !ws->rx_paused && !ws->held);
}

/* Receiving */

static void on_piece(void *ctx, const uint8_t *bytes, size_t size, bool binary, bool last) {
    struct websocket *ws = ctx;
    if (ws->closing)
        return;
    size_t most = ws->connection->server->options.message_bytes;
    ws->too_long |= ws->message.size + size > most;
    if (ws->too_long)
        most = HEAD_BYTES;
    if (ws->message.size < most) /* the beginning may hold the id needed to report the error */
        buf_add(&ws->message, bytes, size < most - ws->message.size ? size : most - ws->message.size);
    if (!last)
        return;
    bool too_long = ws->too_long;
    struct buf message = ws->message;
    ws->message = (struct buf){0};
    ws->too_long = false;
    ws->calls->message(ws->owner, &message, binary, too_long);
    buf_free(&message);
}

/* If pings arrive faster than answers leave, only the last is answered (RFC 6455, 5.5.3). */
static void on_ping(void *ctx, const uint8_t *payload, size_t size) {
    struct websocket *ws = ctx;
    if (ws->closing)
        return;
    queued_message_release(ws->pong);
    ws->pong = queued_message_new(WEBSOCKET_PONG, payload, size);
    go_on(ws);
}

static void on_pong(void *ctx) {
    (void)ctx; /* read_bytes has noted that the client is alive */
}

/* Delays the answer to a close while the client must still receive something (RFC 6455, 5.5.1, permits
 * that). */
static void on_close(void *ctx, enum websocket_status status) {
    struct websocket *ws = ctx;
    if (ws->calls->lingers(ws->owner)) {
        ws->hangs_up = status;
        ws->hang_up_by = websocket_now(ws) + HANG_UP_MS;
    } else {
        bid_farewell(ws, status, "");
    }
}

static void on_fault(void *ctx, enum websocket_status status, const char *why, uint64_t byte) {
    struct websocket *ws = ctx;
    struct error e;
    if (status == WEBSOCKET_BAD_TEXT && !ws->closing) {
        error_at_byte(&e, ERROR_BAD_UTF8, (size_t)byte, "a text must be UTF-8");
        ws->calls->fault(ws->owner, &e);
    } else if (status == WEBSOCKET_TOO_LARGE && !ws->closing) {
        error_set(&e, ERROR_MESSAGE_TOO_LONG, "a message may have at most %u bytes",
                  ws->connection->server->options.message_bytes);
        ws->calls->fault(ws->owner, &e);
    }
    bid_farewell(ws, status, why);
}

static void note_heard(struct websocket *ws) {
    ws->last_rx = websocket_now(ws);
    ws->probe = PROBE_NONE;
}

static void read_bytes(struct connection *c, const char *bytes, size_t size) {
    struct websocket *ws = c->websocket;
    note_heard(ws);
    size_t taken = websocket_reader_feed(&ws->reader, (const uint8_t *)bytes, size);
    buf_add(&ws->unread, bytes + taken, size - taken);
}

void websocket_hold(struct websocket *ws, bool held) {
    ws->held = ws->reader.held = held;
    if (!held) {
        struct buf unread = ws->unread;
        ws->unread = (struct buf){0};
        size_t taken = websocket_reader_feed(&ws->reader, unread.data, unread.size);
        if (taken < unread.size)
            buf_add(&ws->unread, unread.data + taken, unread.size - taken);
        buf_free(&unread);
    }
    listen_again(ws);
}

/* Pings a client that has been silent (RFC 6455, 5.5.2), and closes it if it does not answer. */
static void look(struct connection *c) {
    struct websocket *ws = c->websocket;
    uint64_t silent = websocket_now(ws) - ws->last_rx;
    uint64_t ping_ms = (uint64_t)c->server->options.ping_seconds * 1000;
    if (ws->closing)
        return;
    if (ws->hang_up_by) {
        note_heard(ws); /* after its close the client is silent */
        bool over = !ws->calls->lingers(ws->owner) && message_queue_empty(&ws->queue);
        if (over || websocket_now(ws) >= ws->hang_up_by)
            bid_farewell(ws, ws->hangs_up, "");
        return;
    }
    if (ws->rx_paused || ws->held) {
        note_heard(ws); /* its answers are not read */
    } else if (ws->probe == PROBE_NONE && silent >= ping_ms) {
        ws->probe = PROBE_DUE;
        go_on(ws);
    } else if (ws->probe != PROBE_NONE && silent >= ping_ms + ping_ms / 3) {
        log_info("%s does not answer: closed", c->name);
        connection_close(c);
    }
}

/* Sending */

/* Accounts for the sent bytes of a frame, and keeps the rest until there is room. */
static void note_taken(struct websocket *ws, struct queued_message *message, size_t taken) {
    metrics_add(ws->connection->server->metrics, METRIC_SENT_BYTES, (double)message->size);
    if (taken >= message->head + message->size)
        return;
    ws->leaving = message;
    ws->left_at = taken;
    message->refs++;
}

static void transmit(struct websocket *ws, struct queued_message *message) {
    note_taken(ws, message, connection_send(ws->connection, message->bytes, message->head + message->size));
}

/* Sends the rest of a partly sent message. */
static void transmit_rest(struct websocket *ws) {
    struct queued_message *message = ws->leaving;
    size_t left = message->head + message->size - ws->left_at;
    size_t taken = connection_send(ws->connection, message->bytes + ws->left_at, left);
    ws->left_at += taken;
    if (taken < left)
        return;
    ws->leaving = NULL;
    queued_message_release(message);
}

size_t websocket_send_now(struct websocket *ws, struct queued_message *const *messages, size_t count) {
    struct iovec parts[SEND_TOGETHER];
    size_t sent = 0;
    if (!message_queue_empty(&ws->queue) || ws->close_reason || ws->leaving || ws->pong)
        return 0;
    count = count < SEND_TOGETHER ? count : SEND_TOGETHER;
    for (size_t i = 0; i < count; i++)
        parts[i] = (struct iovec){messages[i]->bytes, messages[i]->head + messages[i]->size};
    size_t left = connection_send_parts(ws->connection, parts, count);
    for (; sent < count && left && !ws->leaving; sent++) {
        size_t now = left < parts[sent].iov_len ? left : parts[sent].iov_len;
        note_taken(ws, messages[sent], now);
        left -= now;
    }
    return sent;
}

void websocket_send(struct websocket *ws, struct queued_message *message) {
    const struct http_options *options = &ws->connection->server->options;
    if (ws->closing)
        return;
    message_queue_push(&ws->queue, message);
    go_on(ws);
    if (!ws->rx_paused && ws->queue.unsent > options->send_bytes) {
        ws->rx_paused = true;
        listen_again(ws);
    }
    if (ws->queue.unsent > options->send_bytes_max && !ws->close_reason) {
        metrics_add(ws->connection->server->metrics, METRIC_TOO_SLOW, 1);
        websocket_close(ws, WEBSOCKET_POLICY, error_name(ERROR_TOO_SLOW));
    }
}

/* Sends the close frame (RFC 6455, 5.5.1), dropping what is queued. */
static void say_goodbye(struct websocket *ws) {
    enum { STATUS_BYTES = 2 };
    uint8_t payload[WEBSOCKET_CONTROL_BYTES] = {(uint8_t)(ws->close_status >> 8), (uint8_t)ws->close_status};
    size_t reason = strlen(ws->close_reason), most = sizeof payload - STATUS_BYTES;
    reason = reason < most ? reason : most;
    memcpy(payload + STATUS_BYTES, ws->close_reason, reason);
    struct queued_message *frame = queued_message_new(
        WEBSOCKET_CLOSE, payload, ws->close_status == WEBSOCKET_NONE ? 0 : STATUS_BYTES + reason);
    ws->closing = true;
    message_queue_close(&ws->queue);
    ws->connection->end_by = websocket_now(ws) + GOODBYE_MS;
    if (ws->rx_paused)
        connection_read(ws->connection, true); /* to read the client's answer */
    transmit(ws, frame);
    queued_message_release(frame);
}

/* Sends the next frame. Returns false if there is none. */
static bool send_next(struct websocket *ws) {
    bool empty = message_queue_empty(&ws->queue);
    if (ws->closing)
        return false;
    /* Clients that are too slow or have closed get only the close frame; others first get what is queued. */
    if (ws->close_reason &&
        (empty || ws->farewell || ws->queue.unsent > ws->connection->server->options.send_bytes_max)) {
        say_goodbye(ws);
        return true;
    }
    struct queued_message *message = ws->pong;
    ws->pong = NULL;
    if (!message && ws->probe == PROBE_DUE) {
        ws->probe = PROBE_SENT;
        message = queued_message_new(WEBSOCKET_PING, "", 0);
    }
    if (!message)
        message = message_queue_pop(&ws->queue);
    if (message)
        transmit(ws, message);
    queued_message_release(message);
    return message != NULL;
}

/* Called after the queue has shrunk. */
static void ease(struct websocket *ws) {
    if (ws->rx_paused && ws->queue.unsent <= ws->connection->server->options.send_bytes) {
        ws->rx_paused = false;
        listen_again(ws);
    }
    if (message_queue_empty(&ws->queue) && !ws->closing)
        ws->calls->drained(ws->owner);
}

static void go_on(struct websocket *ws) {
    if (ws->sending || ws->connection->closing)
        return;
    ws->sending = true;
    if (ws->leaving)
        transmit_rest(ws);
    while (!ws->leaving && send_next(ws))
        ease(ws);
    ws->sending = false;
    if (ws->closing && ws->farewell && !ws->leaving)
        connection_finish(ws->connection);
}

static void on_sent(struct connection *c) {
    go_on(c->websocket);
}

void websocket_close(struct websocket *ws, enum websocket_status status, const char *reason) {
    if (ws->close_reason)
        return;
    ws->close_reason = reason;
    ws->close_status = status;
    go_on(ws);
}

bool websocket_closing(const struct websocket *ws) {
    return ws->closing;
}

struct message_queue *websocket_queue(struct websocket *ws) {
    return &ws->queue;
}

bool websocket_all_sent(const struct websocket *ws) {
    return !ws->leaving && !connection_unsent(ws->connection) && message_queue_empty(&ws->queue);
}

/* Opening and freeing */

static int refuse(struct exchange *x, enum error_code code, const char *why) {
    struct error e;
    error_set(&e, code, "%s", why);
    exchange_error(x, &e);
    return -1;
}

/* Checks for the base64 form of 16 bytes. */
static bool is_key(const char *key) {
    if (!key || strlen(key) != KEY_CHARS || strcmp(key + KEY_CHARS - 2, "=="))
        return false;
    for (size_t i = 0; i < KEY_CHARS - 2; i++)
        if (!isalnum((unsigned char)key[i]) && !strchr("+/", key[i]))
            return false;
    return true;
}

static int check_handshake(struct exchange *x) {
    const struct http_request *r = x->request;
    const char *version = http_header(r, "sec-websocket-version");
    if (!version || strcmp(version, "13") || http_header_count(r, "sec-websocket-version") > 1)
        return refuse(x, ERROR_UPGRADE_REQUIRED,
                      "version 13 of the WebSocket protocol is the one that is supported");
    if (!is_key(http_header(r, "sec-websocket-key")) || http_header_count(r, "sec-websocket-key") > 1)
        return refuse(x, ERROR_BAD_HANDSHAKE, "Sec-WebSocket-Key must be 16 bytes in base64, once");
    if (r->chunked || r->content_length)
        return refuse(x, ERROR_BAD_HANDSHAKE, "a WebSocket is asked for without a body");
    return 0;
}

static int choose_protocol(struct exchange *x, const char *const *known, const char **chosen) {
    struct buf names = {0};
    const char *word;
    size_t at = 0, length;
    *chosen = NULL;
    while (http_header_next(x->request, "sec-websocket-protocol", &at, &word, &length))
        for (size_t i = 0; known[i]; i++)
            if (length == strlen(known[i]) && !strncmp(word, known[i], length)) {
                *chosen = known[i];
                return 0;
            }
    if (!http_header(x->request, "sec-websocket-protocol"))
        return 0;
    buf_printf(&names, "the sub-protocols are %s", known[0]);
    for (size_t i = 1; known[i]; i++)
        buf_printf(&names, "%s%s", known[i + 1] ? ", " : " and ", known[i]);
    refuse(x, ERROR_UNKNOWN_PROTOCOL, (const char *)names.data);
    buf_free(&names);
    return -1;
}

/* Computes Sec-WebSocket-Accept (RFC 6455, 4.2.2, 5.4). */
static void accept_of(const char *key, char accept[ACCEPT_CHARS + 1]) {
    static const char constant[] = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
    char text[KEY_CHARS + sizeof constant];
    unsigned char digest[EVP_MAX_MD_SIZE];
    snprintf(text, sizeof text, "%s%s", key, constant);
    EVP_Digest(text, strlen(text), digest, NULL, EVP_sha1(), NULL);
    EVP_EncodeBlock((unsigned char *)accept, digest, 20);
}

static void push_answer(struct websocket *ws, const struct http_request *r, const char *protocol) {
    char accept[ACCEPT_CHARS + 1];
    struct buf head = {0};
    accept_of(http_header(r, "sec-websocket-key"), accept);
    buf_printf(&head,
               "HTTP/1.1 101 Switching Protocols\r\nupgrade: websocket\r\nconnection: upgrade\r\n"
               "sec-websocket-accept: %s\r\n",
               accept);
    if (protocol)
        buf_printf(&head, "sec-websocket-protocol: %s\r\n", protocol);
    buf_add(&head, "\r\n", 2);
    struct queued_message *answer = queued_message_plain(head.data, head.size);
    message_queue_push(&ws->queue, answer);
    queued_message_release(answer);
    buf_free(&head);
}

static void free_websocket(struct connection *c) {
    struct websocket *ws = c->websocket;
    c->websocket = NULL;
    ws->calls->free(ws->owner);
    buf_free(&ws->message);
    buf_free(&ws->unread);
    websocket_reader_free(&ws->reader);
    message_queue_close(&ws->queue);
    queued_message_release(ws->leaving);
    queued_message_release(ws->pong);
    free(ws);
}

struct websocket *websocket_accept(struct exchange *x, const char *const *protocols, const char **chosen) {
    if (check_handshake(x) || choose_protocol(x, protocols, chosen))
        return NULL;
    static const struct websocket_ear ear = {on_piece, on_ping, on_pong, on_close, on_fault};
    struct websocket *ws = mem_alloc(sizeof *ws);
    ws->connection = x->connection;
    ws->reader = (struct websocket_reader){
        .ear = &ear, .ctx = ws, .most = (uint64_t)MESSAGE_TIMES * x->server->options.message_bytes};
    message_queue_open(&ws->queue);
    push_answer(ws, x->request, *chosen);
    return ws;
}

void websocket_use(struct websocket *ws, const struct websocket_calls *calls, void *owner, const char *name) {
    static const struct connection_protocol protocol = {
        .read = read_bytes, .sent = on_sent, .look = look, .free = free_websocket};
    struct connection *c = ws->connection;
    ws->calls = calls;
    ws->owner = owner;
    c->websocket = ws;
    c->http = NULL; /* the caller of `upgrade` frees the session */
    c->name = name;
    connection_use(c, &protocol);
    note_heard(ws);
}
