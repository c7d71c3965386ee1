/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Utterances that somebody still has in hand: whose text is being written, who is heard, or that are
 * cancelled by name. */
#include "server/stream/stream_internal.h"
#include <string.h>

static struct utterance *numbered(const struct stream *s, uint32_t number) {
    struct utterance *t = s->queue;
    while (t && t->number != number)
        t = t->next;
    return t;
}

static struct utterance *find(const struct stream *s, uint32_t number) {
    struct utterance *t = numbered(s, number);
    return t && t->synthesis ? t : NULL;
}

static bool is_open(const struct utterance *t) {
    return t && (t->live ? live_voice_is_open(t->live) : t->synthesis && synthesis_is_open(t->synthesis));
}

bool stream_is_open(const struct stream *s, uint32_t number) {
    return is_open(numbered(s, number));
}

void stream_sound(struct stream *s, uint32_t number, const uint8_t *bytes, size_t size) {
    struct utterance *t = numbered(s, number);
    if (t && t->live)
        live_voice_write(t->live, bytes, size);
}

int stream_write(struct stream *s, uint32_t number, const char *text, size_t size, size_t most,
                 struct error *e) {
    struct utterance *t = find(s, number);
    return t ? synthesis_write(t->synthesis, text, size, most, e) : 0;
}

void stream_flush(struct stream *s, uint32_t number) {
    struct utterance *t = find(s, number);
    if (t)
        synthesis_flush(t->synthesis);
}

void stream_close(struct stream *s, uint32_t number, const struct error *why) {
    struct utterance *t = numbered(s, number);
    if (!is_open(t))
        return;
    if (why)
        utterance_give(t, &s->sink, s->ctx, (struct stream_event){.kind = STREAM_WARNING, .error = why});
    if (t->live)
        live_voice_close(t->live);
    else
        synthesis_close(t->synthesis);
}

unsigned stream_cancel(struct stream *s, const char *id) {
    unsigned count = 0;
    bool first = false;
    for (struct utterance **at = &s->queue; *at;) {
        const char *own = utterance_id(*at);
        if (!own || strcmp(own, id)) {
            at = &(*at)->next;
            continue;
        }
        count++;
        first |= at == &s->queue;
        if (at == &s->queue)
            stream_end_utterance(s, "stopped");
        else
            stream_forget(s, at);
    }
    if (!first)
        return count;
    stream_forget_unheard(s);
    if (s->queue)
        utterance_start(s->queue);
    stream_wake(s, 0);
    return count;
}
