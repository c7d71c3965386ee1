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

void socket_listen(struct socket *s) {
    connection_read(s->connection, !s->rx_paused && !s->reading);
}

/* Messages that leave together, at most. */
enum { SEND_TOGETHER = 32 };

/* So many bytes of its frame have been taken; the rest is kept until there is room for more. */
static void note_taken(struct socket *s, struct queued_message *message, size_t taken) {
    metrics_add(s->net->pipeline->metrics, METRIC_SENT_BYTES, (double)message->size);
    if (taken >= message->head + message->size)
        return;
    s->leaving = message;
    s->left_at = taken;
    message->refs++;
}

static void transmit(struct socket *s, struct queued_message *message) {
    note_taken(s, message, connection_send(s->connection, message->bytes, message->head + message->size));
}

/* The rest of a message that has been begun. */
static void transmit_rest(struct socket *s) {
    struct queued_message *message = s->leaving;
    size_t left = message->head + message->size - s->left_at;
    size_t taken = connection_send(s->connection, message->bytes + s->left_at, left);
    s->left_at += taken;
    if (taken < left)
        return;
    s->leaving = NULL;
    queued_message_release(message);
}

/* At once, when nothing is before them: so many of them. The others have to wait. */
static size_t transmit_now(struct socket *s, struct queued_message *const *messages, size_t count) {
    struct iovec parts[SEND_TOGETHER];
    size_t sent = 0;
    if (!message_queue_empty(&s->queue) || s->close_reason || s->leaving || s->pong)
        return 0;
    count = count < SEND_TOGETHER ? count : SEND_TOGETHER;
    for (size_t i = 0; i < count; i++)
        parts[i] = (struct iovec){messages[i]->bytes, messages[i]->head + messages[i]->size};
    size_t left = connection_send_parts(s->connection, parts, count);
    for (; sent < count && left && !s->leaving; sent++) {
        size_t now = left < parts[sent].iov_len ? left : parts[sent].iov_len;
        note_taken(s, messages[sent], now);
        left -= now;
    }
    return sent;
}

static void enqueue(struct socket *s, struct queued_message *message) {
    const struct net_options *options = &s->net->options;
    if (s->closing)
        return;
    message_queue_push(&s->queue, message);
    socket_go_on(s);
    if (!s->rx_paused && s->queue.unsent > options->send_bytes) {
        s->rx_paused = true;
        socket_listen(s);
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

void socket_say_text(struct socket *s, const struct buf *text) {
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, text->data, text->size);
    enqueue(s, message);
    queued_message_release(message);
}

/* People who type get lines. */
void socket_say(struct socket *s, json_t *object) {
    struct buf text = {0};
    if (s->plain) {
        text_line(object, &text);
        json_decref(object);
    } else {
        message_write(&text, object);
    }
    if (text.size)
        socket_say_text(s, &text);
    buf_free(&text);
}

void socket_complain(struct socket *s, const struct error *e) {
    json_t *error = message_error(e);
    if (s->asked)
        json_object_set_new(error, "id", json_string(s->asked));
    socket_say(s, error);
}

static struct socket *socket_of(struct follower *f) {
    return (struct socket *)((char *)f - offsetof(struct socket, follower));
}

static void deliver_later(struct socket *s, struct queued_message *message) {
    struct follower *f = &s->follower;
    const struct net_options *options = &s->net->options;
    if (s->plain) {
        if (message->line)
            enqueue(s, message->line);
        return;
    }
    bool full = s->queue.unsent > options->send_bytes ||
                message_queue_age(&s->queue, message->born) > (uint64_t)options->lag_seconds * 1000;
    if (message->media && f->waits)
        return; /* one before it has been left out */
    if (!message->media || !full || !channel_is_room(f->channel)) {
        enqueue(s, message);
        return;
    }
    message_queue_drop_media(&s->queue);
    f->waits = true;
    if (!f->lagging)
        socket_say(s, json_pack("{ss ss ss}", "type", "warning", "code", error_name(ERROR_SKIPPED), "message",
                                "media were left out: they came faster than they were taken"));
    f->lagging = true;
}

void socket_deliver(struct follower *f, struct queued_message *const *messages, size_t count) {
    struct socket *s = socket_of(f);
    for (size_t i = s->plain ? 0 : transmit_now(s, messages, count); i < count; i++)
        deliver_later(s, messages[i]);
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
    s->more = NULL;
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
        socket_listen(s);
    }
    if (!message_queue_empty(&s->queue) || s->closing)
        return;
    if (s->follower.lagging) {
        s->follower.lagging = false;
        channel_resume(&s->follower);
    }
    if (s->more)
        s->more(s);
}

void socket_go_on(struct socket *s) {
    if (s->sending || s->connection->closing)
        return;
    s->sending = true;
    if (s->leaving)
        transmit_rest(s);
    while (!s->leaving && send_next(s))
        go_easy(s);
    s->sending = false;
    if (s->closing && s->farewell && !s->leaving)
        connection_finish(s->connection);
}
