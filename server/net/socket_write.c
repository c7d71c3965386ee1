/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Utterances whose text a WebSocket client is still writing. */
#include "server/net/socket_internal.h"
#include "server/net/surrogates.h"
#include <string.h>

static void complain(struct socket *s, const char *id, const struct error *e) {
    json_t *error = message_error(e);
    if (id)
        json_object_set_new(error, "id", json_string(id));
    socket_say(s, error);
}

/* The id of the message; NULL after a complaint. */
static const char *id_of(struct socket *s, const json_t *message) {
    const json_t *value = json_object_get(message, "id");
    const char *id = json_string_value(value);
    struct error e;
    if (socket_may_direct(s, &e)) {
        complain(s, id, &e);
        return NULL;
    }
    if (id && strlen(id) == json_string_length(value))
        return id;
    error_in_field(&e, value ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "id", "must be a string");
    socket_complain(s, &e);
    return NULL;
}

static struct written *asked(struct socket *s, const json_t *message) {
    const char *id = id_of(s, message);
    struct written *w = id ? written_find(s, id) : NULL;
    struct error e;
    if (id && !w) {
        error_in_field(&e, ERROR_UNKNOWN_UTTERANCE, "id", "no utterance '%.64s' is being written here", id);
        complain(s, id, &e);
    }
    return w;
}

void write_text(struct socket *s, const json_t *message) {
    const json_t *text = json_object_get(message, "text");
    struct written *w = asked(s, message);
    struct error e;
    if (!w)
        return;
    int wrong = 0;
    struct buf joined = {0};
    surrogates_join(json_string_value(text) ? json_string_value(text) : "", json_string_length(text),
                    &w->half, &joined);
    if (!json_is_string(text))
        wrong = error_in_field(&e, text ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "text", "must be a string");
    if (wrong || stream_write(socket_stream(s), w->utterance, joined.size ? (const char *)joined.data : "",
                              joined.size, s->net->options.text_bytes, &e))
        complain(s, w->id, &e);
    buf_free(&joined);
}

void write_flush(struct socket *s, const json_t *message) {
    const struct written *w = asked(s, message);
    if (w)
        stream_flush(socket_stream(s), w->utterance);
}

void write_close(struct socket *s, const json_t *message) {
    struct written *w = asked(s, message);
    if (!w)
        return;
    uint32_t utterance = w->utterance;
    struct error e;
    if (w->half) {
        error_set(&e, ERROR_BAD_UTF8, "the text ends in half a character, which is left out");
        json_t *warning = message_error(&e);
        json_object_set_new(warning, "type", json_string("warning"));
        json_object_set_new(warning, "id", json_string(w->id));
        socket_say(s, warning);
    }
    written_drop(s, w);
    stream_close(socket_stream(s), utterance, NULL);
}

void write_cancel(struct socket *s, const json_t *message) {
    const char *id = id_of(s, message);
    struct error e;
    if (!id || stream_cancel(socket_stream(s), id))
        return;
    error_in_field(&e, ERROR_UNKNOWN_UTTERANCE, "id", "no utterance '%.64s' is spoken or waits", id);
    complain(s, id, &e);
}
