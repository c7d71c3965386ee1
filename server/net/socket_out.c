/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goes out to a WebSocket client: the queue of it, and how he is told goodbye. */
#include "server/net/socket_parts.h"
#include <string.h>

/* So long a client may take to answer a goodbye. */
enum { GOODBYE_SECONDS = 2 };

void socket_dismiss(struct socket *s, enum lws_close_status status, const char *reason) {
    if (s->doomed)
        return;
    s->doomed = reason;
    s->doom = status;
    lws_callback_on_writable(s->wsi);
}

/* -1: the connection is broken. */
static int transmit(struct socket *s, struct parcel *parcel) {
    s->progress = uv_now(s->net->studio->loop);
    metrics_add(s->net->studio->metrics, METRIC_SENT_BYTES, (double)parcel->size);
    return lws_write(s->wsi, parcel_body(parcel), parcel->size, parcel->type) < 0 ? -1 : 0;
}

/* At once, when nothing is before it and the connection takes it: to wait for the callback costs more than
 * the sending. false: it has to wait. */
static bool transmit_now(struct socket *s, struct parcel *parcel) {
    if (!outbox_empty(&s->outbox) || s->doomed || s->closing || s->broken || lws_send_pipe_choked(s->wsi))
        return false;
    if (transmit(s, parcel)) {
        s->broken = true;
        lws_callback_on_writable(s->wsi); /* there it can be closed */
    }
    return true;
}

static void enqueue(struct socket *s, struct parcel *parcel) {
    const struct net_options *options = &s->net->options;
    if (outbox_empty(&s->outbox))
        s->progress = uv_now(s->net->studio->loop);
    outbox_push(&s->outbox, parcel);
    if (!s->deaf && s->outbox.unsent > options->send_bytes) {
        s->deaf = true;
        lws_rx_flow_control(s->wsi, 0);
    }
    if (s->outbox.unsent > options->send_bytes_max && !s->doomed) {
        metrics_add(s->net->studio->metrics, METRIC_TOO_SLOW, 1);
        socket_dismiss(s, LWS_CLOSE_STATUS_POLICY_VIOLATION, "too-slow");
    }
    lws_callback_on_writable(s->wsi);
}

/* One who types gets lines. */
static void push(struct socket *s, struct parcel *parcel) {
    struct buf line = {0};
    if (!s->plain) {
        enqueue(s, parcel);
        return;
    }
    text_line((const char *)parcel_body(parcel), parcel->size, &line);
    if (line.size) {
        struct parcel *said = parcel_new(LWS_WRITE_TEXT, line.data, line.size);
        enqueue(s, said);
        parcel_release(said);
    }
    buf_free(&line);
}

void socket_say_text(struct socket *s, const struct buf *text) {
    struct parcel *parcel = parcel_new(LWS_WRITE_TEXT, text->data, text->size);
    push(s, parcel);
    parcel_release(parcel);
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

void socket_deliver(struct follower *f, struct parcel *parcel) {
    struct socket *s = socket_of(f);
    const struct net_options *options = &s->net->options;
    bool full = s->outbox.unsent > options->send_bytes ||
                outbox_age(&s->outbox, parcel->born) > (uint64_t)options->lag_seconds * 1000;
    if (!s->plain && transmit_now(s, parcel))
        return;
    if (!parcel->media || !full || !channel_is_room(f->channel)) {
        push(s, parcel);
        return;
    }
    outbox_drop_media(&s->outbox);
    f->waits = true;
    if (!f->lagging)
        socket_say(s, json_pack("{ss ss ss}", "type", "warning", "code", "skipped", "message",
                                "media were left out: they came faster than they were taken"));
    f->lagging = true;
}

/* What lws_close_reason does, had it a chance: with libuv, libwebsockets 4.1 closes a connection whose
 * callback returned -1 twice, the second time without waiting for its close frame. So that frame (RFC
 * 6455, 5.5.1) is written here, by the number that the library has for it, and the client's answer ends the
 * connection. */
static int say_goodbye(struct socket *s) {
    enum { WRITE_CLOSE = 4, STATUS_BYTES = 2, REASON_BYTES = 64 };
    uint8_t frame[LWS_PRE + STATUS_BYTES + REASON_BYTES], *payload = frame + LWS_PRE;
    size_t size = strlen(s->doomed) < REASON_BYTES ? strlen(s->doomed) : REASON_BYTES;
    payload[0] = (uint8_t)(s->doom >> 8);
    payload[1] = (uint8_t)s->doom;
    memcpy(payload + STATUS_BYTES, s->doomed, size);
    lws_set_timeout(s->wsi, PENDING_TIMEOUT_CLOSE_ACK, GOODBYE_SECONDS);
    return lws_write(s->wsi, payload, STATUS_BYTES + size, (enum lws_write_protocol)WRITE_CLOSE) < 0 ? -1 : 0;
}

int socket_writeable(struct socket *s) {
    if (s->closing)
        return 0;
    if (s->broken)
        return -1;
    if (s->probe == PROBE_DUE)
        return socket_ping(s);
    /* he who is too slow gets nothing more; others get what is on its way */
    if (s->doomed && (outbox_empty(&s->outbox) || s->outbox.unsent > s->net->options.send_bytes_max)) {
        s->closing = true;
        return say_goodbye(s);
    }
    struct parcel *parcel = outbox_pop(&s->outbox);
    if (!parcel)
        return 0;
    int sent = transmit(s, parcel);
    parcel_release(parcel);
    if (sent < 0)
        return -1;
    if (s->deaf && s->outbox.unsent <= s->net->options.send_bytes) {
        s->deaf = false;
        lws_rx_flow_control(s->wsi, 1);
    }
    if (s->follower.lagging && outbox_empty(&s->outbox)) {
        s->follower.lagging = false;
        channel_resume(&s->follower);
    }
    if (outbox_empty(&s->outbox) && s->model)
        socket_push_model_part(s);
    if (!outbox_empty(&s->outbox) || s->doomed)
        lws_callback_on_writable(s->wsi);
    return 0;
}

bool sockets_busy(const struct net *net) {
    for (const struct socket *s = net->sockets; s; s = s->next)
        if (!outbox_empty(&s->outbox) || stream_busy(socket_stream(s)))
            return true;
    return false;
}

void sockets_dismiss(struct net *net, const char *reason) {
    for (struct socket *s = net->sockets; s; s = s->next)
        socket_dismiss(s, LWS_CLOSE_STATUS_GOINGAWAY, reason);
}
