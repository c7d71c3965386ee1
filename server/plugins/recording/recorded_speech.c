/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/recording/recorded_speech.h"
#include "server/plugins/recording/tempo.h"

enum { UNKNOWN_PACE = 170 }; /* words a minute: what the host takes of a voice that does not tell */

static bool is_text(const struct faccia_span *span) {
    return span->kind == FACCIA_SPAN_TEXT;
}

/* What was asked for and cannot be done with a recording. */
static void warn(const struct faccia_sentence *sentence, const struct faccia_sink *sink) {
    bool changed = false, paused = false;
    for (size_t i = 0; i < sentence->span_count; i++) {
        const struct faccia_span *s = &sentence->spans[i];
        paused |= s->kind == FACCIA_SPAN_BREAK;
        changed |= is_text(s) && (s->pitch != 1 || s->range != 1 || s->volume != 1 || s->emphasis ||
                                  s->phones || s->emotion);
    }
    if (changed)
        sink->warning(sink->ctx, "a recording is heard as it was spoken: its pitch, volume and words stay");
    if (paused)
        sink->warning(sink->ctx, "a recording pauses where the speaker paused");
}

static double speed_of(const struct faccia_span *span, const struct recorded *r, bool *bounded) {
    double speed =
        span->rate > 0 ? span->rate / (r->words_per_minute ? r->words_per_minute : UNKNOWN_PACE) : 1;
    double within = speed < TEMPO_MIN ? TEMPO_MIN : speed > TEMPO_MAX ? TEMPO_MAX : speed;
    *bounded |= within != speed;
    return within;
}

/* Each span's words begin at its speed; what is before the first word has that word's. */
static void choose_tempo(struct tempo *tempo, const struct match *m, const struct recorded *r, uint64_t from,
                         uint64_t samples, const struct faccia_sink *sink) {
    bool bounded = false;
    for (size_t i = 0; i < m->tokens.count; i++)
        if (!i || m->spans[i] != m->spans[i - 1]) {
            uint64_t at = i ? match_time(m, r->reading, i, false, from, samples) : 0;
            tempo_add(tempo, (uint32_t)at, speed_of(&m->sentence->spans[m->spans[i]], r, &bounded));
        }
    if (bounded)
        sink->warning(sink->ctx, "a recording is heard at a quarter to four times its own rate");
}

void recorded_speech_give(const struct match *m, const struct recorded *r, double pause,
                          const struct faccia_sink *sink) {
    const struct faccia_sentence *sentence = m->sentence;
    struct tempo tempo = {0};
    uint64_t from, to;
    bool stop = false;
    size_t next = 0;
    aligned_recording_stretch(r->reading, m->at, m->at + m->tokens.count, pause, &from, &to);
    struct sentence_audio *u = aligned_recording_audio(r->reading, from, to);
    uint64_t samples = u->samples; /* of the recording */
    warn(sentence, sink);
    choose_tempo(&tempo, m, r, from, samples, sink);
    tempo_apply(&tempo, u);
    for (size_t i = 0; i < u->phone_count && !stop; i++) {
        const struct phone *p = &u->phones[i];
        stop = sink->phone(sink->ctx, &(struct faccia_phone){p->ipa, p->symbol, p->start, p->end, p->stress});
    }
    for (uint32_t s = 0; s < sentence->span_count && !stop; s++) {
        for (; next < m->tokens.count && m->spans[next] == s && !stop; next++) {
            const struct text_word *t = &m->tokens.list[next];
            uint64_t start = match_time(m, r->reading, next, false, from, samples);
            uint64_t end = match_time(m, r->reading, next, true, from, samples);
            struct faccia_word word = {s, t->from, t->to - t->from, tempo_at(&tempo, u, start),
                                       tempo_at(&tempo, u, end)};
            stop = sink->word(sink->ctx, &word);
        }
        if (sentence->spans[s].kind == FACCIA_SPAN_MARK && !stop) {
            uint64_t at =
                next < m->tokens.count ? match_time(m, r->reading, next, false, from, samples) : samples;
            stop = sink->mark(sink->ctx, sentence->spans[s].text, tempo_at(&tempo, u, at));
        }
    }
    if (!stop)
        sink->audio(sink->ctx, u->pcm, u->samples, u->sample_rate);
    sentence_audio_free(u);
    tempo_free(&tempo);
}
