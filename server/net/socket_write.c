/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Utterances whose text a WebSocket client is still writing. */
#include "server/base/mem.h"
#include "server/net/socket_internal.h"
#include <stdlib.h>
#include <string.h>

/* On the stream that the client is on. Its utterance may have ended meanwhile. */
struct written {
    char *id;
    uint32_t utterance;
};

static struct written *find(struct socket *s, const char *id) {
    for (size_t i = 0; i < s->written_count; i++)
        if (!strcmp(s->written[i].id, id))
            return &s->written[i];
    return NULL;
}

static bool is_open(const struct socket *s, const struct written *w) {
    return stream_is_open(socket_stream(s), w->utterance);
}

static void drop(struct socket *s, struct written *w) {
    free(w->id);
    s->written_count--;
    memmove(w, w + 1, (size_t)(s->written + s->written_count - w) * sizeof *w);
}

int write_check(struct socket *s, const struct speech_request *request, struct error *e) {
    size_t open = 0;
    if (!request->id)
        return error_in_field(e, ERROR_MISSING_FIELD, "id", "an utterance that is open needs one");
    const struct written *same = find(s, request->id);
    if (same && is_open(s, same))
        return error_in_field(e, ERROR_BAD_FIELD, "id", "one of that id is open already");
    for (size_t i = 0; i < s->written_count; i++)
        open += is_open(s, &s->written[i]);
    if (open >= s->net->options.open)
        return error_set(e, ERROR_TOO_MANY_OPEN, "%zu texts are being written already", open);
    return 0;
}

void write_begin(struct socket *s, const char *id, uint32_t utterance) {
    for (size_t i = s->written_count; i-- > 0;)
        if (!strcmp(s->written[i].id, id) ||
            (s->written_count >= s->net->options.open && !is_open(s, &s->written[i])))
            drop(s, &s->written[i]);
    s->written = mem_grow(s->written, &s->written_cap, s->written_count + 1, sizeof *s->written);
    s->written[s->written_count++] = (struct written){mem_strdup(id), utterance};
}

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
    struct written *w = id ? find(s, id) : NULL;
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
    if (!json_is_string(text))
        wrong = error_in_field(&e, text ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "text", "must be a string");
    if (wrong || stream_write(socket_stream(s), w->utterance, json_string_value(text),
                              json_string_length(text), s->net->options.text_bytes, &e))
        complain(s, w->id, &e);
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
    drop(s, w);
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

void write_leave(struct socket *s) {
    struct error e;
    error_set(&e, ERROR_UNFINISHED, "who wrote it has gone: the text is taken as it is");
    while (s->written_count) {
        struct written *w = &s->written[s->written_count - 1];
        if (s->follower.channel)
            stream_close(socket_stream(s), w->utterance, &e);
        drop(s, w);
    }
    free(s->written);
    s->written = NULL;
    s->written_cap = 0;
}
