/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which utterances a WebSocket client is writing. */
#include "server/base/mem.h"
#include "server/net/socket_internal.h"
#include <stdlib.h>
#include <string.h>

/* The one that it is on; NULL: none any more. */
static struct stream *stream_of(const struct socket *s) {
    return s->follower.channel ? channel_stream(s->follower.channel) : NULL;
}

struct written *written_find(struct socket *s, const char *id) {
    for (size_t i = 0; i < s->written_count; i++)
        if (!strcmp(s->written[i].id, id))
            return &s->written[i];
    return NULL;
}

static bool is_open(const struct socket *s, const struct written *w) {
    return stream_is_open(stream_of(s), w->utterance);
}

void written_drop(struct socket *s, struct written *w) {
    free(w->id);
    s->written_count--;
    memmove(w, w + 1, (size_t)(s->written + s->written_count - w) * sizeof *w);
}

int write_check(struct socket *s, const struct speech_request *request, struct error *e) {
    size_t open = 0;
    if (!request->id)
        return error_in_field(e, ERROR_MISSING_FIELD, "id", "an utterance that is open needs one");
    const struct written *same = written_find(s, request->id);
    if (same && is_open(s, same))
        return error_in_field(e, ERROR_BAD_FIELD, "id", "one of that id is open already");
    for (size_t i = 0; i < s->written_count; i++)
        open += is_open(s, &s->written[i]);
    if (open >= s->net->options.open)
        return error_set(e, ERROR_TOO_MANY_OPEN, "%zu texts are being written already", open);
    return 0;
}

void write_begin(struct socket *s, const char *id, uint32_t utterance, uint16_t half) {
    for (size_t i = s->written_count; i-- > 0;)
        if (!strcmp(s->written[i].id, id) ||
            (s->written_count >= s->net->options.open && !is_open(s, &s->written[i])))
            written_drop(s, &s->written[i]);
    s->written = mem_grow(s->written, &s->written_cap, s->written_count + 1, sizeof *s->written);
    s->written[s->written_count++] = (struct written){mem_strdup(id), utterance, half};
}

void write_leave(struct socket *s) {
    struct error e;
    error_set(&e, ERROR_UNFINISHED, "who wrote it has gone: the text is taken as it is");
    while (s->written_count) {
        struct written *w = &s->written[s->written_count - 1];
        if (stream_of(s))
            stream_close(stream_of(s), w->utterance, &e);
        written_drop(s, w);
    }
    s->voice = 0;
    free(s->written);
    s->written = NULL;
    s->written_cap = 0;
}
