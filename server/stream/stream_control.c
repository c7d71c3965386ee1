/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Directing what speaks already: pause and resume, the rate, jumps to marks. */
#include "server/stream/stream_internal.h"

static uint64_t now_of(const struct stream *s) {
    return uv_now(s->pipeline->loop);
}

/* An event of the utterance that is heard, at the place where it stands; of none when none has begun. */
static void tell(struct stream *s, enum stream_event_kind kind, const char *text) {
    const struct utterance *t = s->queue;
    struct stream_event event = {.kind = kind, .text = text, .idle = -1};
    if (kind == STREAM_RESUMED)
        event.idle = stream_idle_time(s, now_of(s));
    if (!t || (!t->begun && kind != STREAM_JUMPED)) {
        s->sink.event(s->ctx, &event);
        return;
    }
    event.sample = utterance_heard(t, kind == STREAM_JUMPED ? 0 : s->unheard);
    utterance_give(t, &s->sink, s->ctx, event);
}

void stream_pause(struct stream *s) {
    uint64_t now = now_of(s);
    if (s->paused)
        return;
    s->unheard = s->spoken_until > now ? s->spoken_until - now : 0;
    if (s->unheard)
        stream_go_on_from(s, now);
    s->spoken_until = 0;
    s->paused = true;
    if (s->unheard || (s->queue && s->queue->begun))
        stream_cut_face(s);
    tell(s, STREAM_PAUSED, NULL);
    stream_wake(s, 0);
}

void stream_resume(struct stream *s) {
    struct utterance *t = s->queue;
    uint64_t now = now_of(s);
    if (!s->paused)
        return;
    s->paused = false;
    if (t && t->heard)
        heard_voice_catch_up(t->heard);
    if (t && t->begun) {
        stream_resume_utterance(s, now);
    } else if (s->unheard) { /* the end of one that has left whole */
        stream_go_on_from(s, now);
        s->life += (double)s->unheard / 1000;
        s->played_until = s->spoken_until = now + s->unheard;
    }
    tell(s, STREAM_RESUMED, NULL);
    s->unheard = 0;
    stream_wake(s, 0);
}

int stream_rate(struct stream *s, double rate, struct error *e) {
    if (!(rate >= REQUEST_RATE_MIN && rate <= REQUEST_RATE_MAX))
        return error_in_field(e, ERROR_BAD_FIELD, "rate", "must be a number from %d to %d", REQUEST_RATE_MIN,
                              REQUEST_RATE_MAX);
    for (struct utterance *t = s->queue; t; t = t->next) {
        if (!t->synthesis)
            continue;
        synthesis_set_rate(t->synthesis, rate);
        if (t->started)
            utterance_respeak(t);
    }
    return 0;
}

int stream_jump(struct stream *s, const char *mark, struct error *e) {
    struct utterance *t = s->queue;
    size_t sentence;
    if (!t)
        return error_set(e, ERROR_NOT_SPEAKING, "nothing is spoken");
    if (!t->synthesis || !synthesis_find_mark(t->synthesis, mark, &sentence)) {
        struct suggestions near = suggestions_for(mark);
        char text[SUGGESTIONS_TEXT];
        if (t->synthesis)
            synthesis_near_marks(t->synthesis, &near);
        return error_in_field(e, ERROR_UNKNOWN_MARK, "mark", "the utterance has no mark '%.80s'%s", mark,
                              suggestions_text(&near, text));
    }
    stream_forget_unheard(s);
    utterance_seek(t, sentence, mark);
    stream_cut_face(s);
    tell(s, STREAM_JUMPED, mark);
    return 0;
}
