/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goes out to a WebSocket client: the queue of it, and how he is told goodbye. */
#include "server/net/socket_internal.h"
#include <string.h>

/* So long a client may take to answer a goodbye. */
enum { GOODBYE_MS = 2000 };

void socket_dismiss(struct socket *s, enum websocket_status status, const char *reason) {
    if (s->close_reason)
        return;
    s->close_reason = reason;
    s->close_status = status;
    socket_go_on(s);
}

void socket_farewell(struct socket *s, enum websocket_status status, const char *reason) {
    s->farewell = true;
    if (s->closing) {
        socket_go_on(s);
        return;
    }
    s->close_reason = NULL;
    socket_dismiss(s, status, reason);
}

/* True: all of it has left. */
static bool transmit(struct socket *s, struct queued_message *message) {
    metrics_add(s->net->pipeline->metrics, METRIC_SENT_BYTES, (double)message->size);
    if (connection_send(s->connection, message->bytes, message->head + message->size))
        return true;
    s->leaving = message;
    message->refs++;
    return false;
}

/* At once, when nothing is before it. False: it has to wait. */
static bool transmit_now(struct socket *s, struct queued_message *message) {
    if (!message_queue_empty(&s->queue) || s->close_reason || s->leaving || s->pong)
        return false;
    transmit(s, message);
    return true;
}

static void enqueue(struct socket *s, struct queued_message *message) {
    const struct net_options *options = &s->net->options;
    if (s->closing)
        return;
    message_queue_push(&s->queue, message);
    socket_go_on(s);
    if (!s->rx_paused && s->queue.unsent > options->send_bytes) {
        s->rx_paused = true;
        connection_read(s->connection, false);
    }
    if (s->queue.unsent > options->send_bytes_max && !s->close_reason) {
        metrics_add(s->net->pipeline->metrics, METRIC_TOO_SLOW, 1);
        socket_dismiss(s, WEBSOCKET_POLICY, error_name(ERROR_TOO_SLOW));
    }
}

void socket_pong(struct socket *s, const void *payload, size_t size) {
    if (s->closing)
        return;
    queued_message_release(s->pong);
    s->pong = queued_message_new(WEBSOCKET_PONG, payload, size);
    socket_go_on(s);
}

void socket_ping(struct socket *s) {
    s->probe = PROBE_DUE;
    socket_go_on(s);
}

/* One who types gets lines. */
static void push(struct socket *s, struct queued_message *message) {
    struct buf line = {0};
    if (!s->plain) {
        enqueue(s, message);
        return;
    }
    text_line((const char *)queued_message_body(message), message->size, &line);
    if (line.size) {
        struct queued_message *said = queued_message_new(WEBSOCKET_TEXT, line.data, line.size);
        enqueue(s, said);
        queued_message_release(said);
    }
    buf_free(&line);
}

void socket_say_text(struct socket *s, const struct buf *text) {
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, text->data, text->size);
    push(s, message);
    queued_message_release(message);
}

void socket_say(struct socket *s, json_t *object) {
    struct buf text = {0};
    message_write(&text, object);
    socket_say_text(s, &text);
    buf_free(&text);
}

void socket_complain(struct socket *s, const struct error *e) {
    socket_say(s, message_error(e));
}

static struct socket *socket_of(struct follower *f) {
    return (struct socket *)((char *)f - offsetof(struct socket, follower));
}

void socket_deliver(struct follower *f, struct queued_message *message) {
    struct socket *s = socket_of(f);
    const struct net_options *options = &s->net->options;
    bool full = s->queue.unsent > options->send_bytes ||
                message_queue_age(&s->queue, message->born) > (uint64_t)options->lag_seconds * 1000;
    if (!s->plain && transmit_now(s, message))
        return;
    if (!message->media || !full || !channel_is_room(f->channel)) {
        push(s, message);
        return;
    }
    message_queue_drop_media(&s->queue);
    f->waits = true;
    if (!f->lagging)
        socket_say(s, json_pack("{ss ss ss}", "type", "warning", "code", error_name(ERROR_SKIPPED), "message",
                                "media were left out: they came faster than they were taken"));
    f->lagging = true;
}

/* The close frame (RFC 6455, 5.5.1), before which nothing waits any more. */
static void say_goodbye(struct socket *s) {
    enum { STATUS_BYTES = 2 };
    uint8_t payload[WEBSOCKET_CONTROL_BYTES] = {(uint8_t)(s->close_status >> 8), (uint8_t)s->close_status};
    size_t reason = strlen(s->close_reason), most = sizeof payload - STATUS_BYTES;
    reason = reason < most ? reason : most;
    memcpy(payload + STATUS_BYTES, s->close_reason, reason);
    struct queued_message *frame = queued_message_new(
        WEBSOCKET_CLOSE, payload, s->close_status == WEBSOCKET_NONE ? 0 : STATUS_BYTES + reason);
    s->closing = true;
    message_queue_close(&s->queue);
    s->model = NULL;
    s->connection->end_by = connection_now(s->connection) + GOODBYE_MS;
    if (s->rx_paused)
        connection_read(s->connection, true); /* to hear the client's answer */
    transmit(s, frame);
    queued_message_release(frame);
}

/* The next thing that has to leave. False: there is none. */
static bool send_next(struct socket *s) {
    bool empty = message_queue_empty(&s->queue);
    if (s->closing)
        return false;
    /* one that is too slow gets nothing more, nor does one that has closed; others get what is on its way */
    if (s->close_reason && (empty || s->farewell || s->queue.unsent > s->net->options.send_bytes_max)) {
        say_goodbye(s);
        return true;
    }
    struct queued_message *message = s->pong;
    s->pong = NULL;
    if (!message && s->probe == PROBE_DUE) {
        s->probe = PROBE_SENT;
        message = queued_message_new(WEBSOCKET_PING, "", 0);
    }
    if (!message)
        message = message_queue_pop(&s->queue);
    if (message)
        transmit(s, message);
    queued_message_release(message);
    return message != NULL;
}

/* Less waits than before. */
static void go_easy(struct socket *s) {
    if (s->rx_paused && s->queue.unsent <= s->net->options.send_bytes) {
        s->rx_paused = false;
        connection_read(s->connection, true);
    }
    if (!message_queue_empty(&s->queue) || s->closing)
        return;
    if (s->follower.lagging) {
        s->follower.lagging = false;
        channel_resume(&s->follower);
    }
    if (s->model)
        socket_push_model_part(s);
}

void socket_go_on(struct socket *s) {
    if (s->sending || s->connection->sending || s->connection->closing)
        return;
    queued_message_release(s->leaving);
    s->leaving = NULL;
    s->sending = true;
    while (!s->leaving && send_next(s))
        go_easy(s);
    s->sending = false;
    if (s->closing && s->farewell && !s->leaving)
        connection_finish(s->connection);
}

bool sockets_busy(const struct net *net) {
    for (const struct socket *s = net->sockets; s; s = s->next)
        if (s->leaving || !message_queue_empty(&s->queue) || stream_busy(socket_stream(s)))
            return true;
    return false;
}

void sockets_dismiss(struct net *net, const char *reason) {
    for (struct socket *s = net->sockets; s; s = s->next)
        socket_dismiss(s, WEBSOCKET_GOING_AWAY, reason);
}
