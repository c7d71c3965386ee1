/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/stream/stream_internal.h"
#include <stdlib.h>
#include <string.h>

static void segment_cut_media(struct segment_cut *cut, const struct media_segment *segment,
                              struct face_placement *face, double fps, uint32_t samples,
                              struct media *media) {
    const struct sentence_audio *u = segment->audio;
    if (samples > u->samples - cut->at)
        samples = u->samples - cut->at;
    uint64_t start = (uint64_t)(segment->start + cut->at);
    uint32_t first = frame_from_sample(start, u->sample_rate, fps);
    uint32_t end = frame_from_sample(start + samples, u->sample_rate, fps);
    for (uint32_t k = first; k < end; k++)
        media_segment_frame(segment, face, fps, k, &media->frames[k - first]);
    *media = (struct media){.sample_rate = u->sample_rate,
                            .fps = fps,
                            .start = (uint32_t)start,
                            .samples = samples,
                            .pcm = u->pcm ? u->pcm + cut->at : NULL,
                            .first_frame = first,
                            .frame_count = end - first,
                            .frames = media->frames};
    cut->at += samples;
}

/* Enters the segment at its first audible sample. */
static void segment_cut_enter(struct segment_cut *cut, const struct media_segment *segment) {
    const struct sentence_audio *u = segment->audio;
    *cut = (struct segment_cut){.at = segment->skip};
    while (cut->word < u->word_count && u->words[cut->word].start < cut->at)
        cut->word++;
    while (cut->mark < u->mark_count && u->marks[cut->mark].at < cut->at)
        cut->mark++;
    while (cut->phone < u->phone_count && u->phones[cut->phone].start < cut->at)
        cut->phone++;
}

void utterance_start(struct utterance *t) {
    if (t->started)
        return;
    t->started = true;
    t->source->ops->start(t->source);
}

double utterance_fps(const struct utterance *t) {
    return t->source->ops->fps(t->source);
}

const char *utterance_id(const struct utterance *t) {
    return t->source->ops->id(t->source);
}

void utterance_give(const struct utterance *t, const struct stream_sink *sink, void *ctx,
                    struct stream_event event) {
    event.utterance = t->number;
    event.id = t->source ? utterance_id(t) : event.id;
    event.sample_rate = t->sample_rate;
    event.command = t->command;
    sink->event(ctx, &event);
}

void utterance_add_segment(struct utterance *t, struct media_segment segment) {
    t->segments = mem_grow(t->segments, &t->segment_cap, t->segment_count + 1, sizeof *t->segments);
    t->segments[t->segment_count++] = segment;
}

bool utterance_is_apart(const struct utterance *t) {
    return t->source->own_face;
}

bool utterance_is_foreign(const struct utterance *t) {
    const struct speech_source *source = t->source;
    return source->own_face || source->one_face || source->request->life >= 0;
}

void utterance_unplace(struct utterance *t) {
    face_placement_free(t->face);
    t->face = NULL;
}

static void drop_segment(struct utterance *t) {
    if (!t->source->one_face)
        utterance_unplace(t);
    media_segment_free(&t->segments[0]);
    t->segment_count--;
    memmove(t->segments, t->segments + 1, t->segment_count * sizeof *t->segments);
    t->cut = (struct segment_cut){0};
    t->sentence_said = false;
}

void utterance_drop_segment_if_done(struct utterance *t) {
    bool wait = t->segments[0].wait;
    if (t->cut.at < t->segments[0].audio->samples)
        return;
    drop_segment(t);
    if (!wait)
        t->source->ops->release(t->source);
}

void utterance_free(struct utterance *t) {
    while (t->segment_count)
        drop_segment(t);
    utterance_unplace(t);
    t->source->ops->free(t->source);
    mood_free(t->mood);
    free(t->segments);
    free(t);
}

static struct stream_event place_of(struct utterance *t, enum stream_event_kind kind, uint32_t from,
                                    uint32_t to, size_t start, size_t end) {
    const char *text = t->source->request->text;
    size_t utf16_start = utf16_offset(&t->utf16, text, start);
    return (struct stream_event){.kind = kind,
                                 .sample = (uint32_t)(t->segments[0].start + from),
                                 .duration = to - from,
                                 .start = start,
                                 .end = end,
                                 .utf16_start = utf16_start,
                                 .utf16_end = utf16_offset(&t->utf16, text, end),
                                 .text = text + start};
}

static void say_speaker(struct utterance *t, const struct stream_sink *sink, void *ctx, size_t byte,
                        uint32_t at) {
    const struct speaker *who = synthesis_speaker(t->source->text, byte);
    struct stream_event event = {.kind = STREAM_SPEAKER, .sample = (uint32_t)(t->segments[0].start + at)};
    event.text = who ? who->id : "";
    event.name = who ? who->name : "";
    utterance_give(t, sink, ctx, event);
}

/* Reports what begins before the cut and was not reported yet. */
static void say_events(struct utterance *t, const struct stream_sink *sink, void *ctx) {
    const struct media_segment *segment = &t->segments[0];
    const struct sentence_audio *u = segment->audio;
    bool last = t->cut.at == u->samples;
    if (!t->sentence_said && t->source->text && !segment->wait) {
        utterance_give(t, sink, ctx, place_of(t, STREAM_SENTENCE, segment->skip, u->samples, u->from, u->to));
        if (synthesis_has_speakers(t->source->text))
            say_speaker(t, sink, ctx, u->from, segment->skip);
    }
    t->sentence_said = true;
    for (; t->cut.word < u->word_count && (last || u->words[t->cut.word].start < t->cut.at); t->cut.word++) {
        const struct word *w = &u->words[t->cut.word];
        utterance_give(t, sink, ctx, place_of(t, STREAM_WORD, w->start, w->end, w->from, w->to));
    }
    bool phones = t->source->text && t->source->request->phones;
    for (; t->cut.phone < u->phone_count && (last || u->phones[t->cut.phone].start < t->cut.at);
         t->cut.phone++) {
        const struct phone *p = &u->phones[t->cut.phone];
        if (phones)
            utterance_give(t, sink, ctx,
                           (struct stream_event){.kind = STREAM_PHONE,
                                                 .sample = (uint32_t)(segment->start + p->start),
                                                 .duration = p->end - p->start,
                                                 .text = p->ipa});
    }
    for (; t->cut.mark < u->mark_count && (last || u->marks[t->cut.mark].at < t->cut.at); t->cut.mark++) {
        const struct mark *m = &u->marks[t->cut.mark];
        utterance_give(t, sink, ctx,
                       (struct stream_event){.kind = STREAM_MARK,
                                             .sample = (uint32_t)(segment->start + m->at),
                                             .text = m->name});
    }
}

void utterance_cut(struct utterance *t, unsigned ms, const struct stream_sink *sink, void *ctx,
                   struct media *media) {
    const struct media_segment *segment = &t->segments[0];
    uint32_t most = (uint32_t)((uint64_t)segment->audio->sample_rate * ms / 1000);
    if (!t->sentence_said)
        segment_cut_enter(&t->cut, segment);
    segment_cut_media(&t->cut, segment, t->face, utterance_fps(t), most, media);
    media->utterance = t->number;
    t->sent += media->samples;
    say_events(t, sink, ctx);
}

bool utterance_awaits(const struct utterance *t) {
    const struct speech_source_ops *ops = t->source->ops;
    return t->begun && !t->segment_count && ops->awaits && ops->awaits(t->source);
}

int64_t utterance_patience(const struct utterance *t) {
    const struct speech_source_ops *ops = t->source->ops;
    unsigned grace = ops->grace ? ops->grace(t->source) : 0;
    return grace ? -(int64_t)grace : STREAM_WAIT_MS;
}

uint32_t utterance_heard(const struct utterance *t, uint64_t unheard) {
    uint64_t samples = unheard * t->sample_rate / 1000;
    return samples < t->sent ? (uint32_t)(t->sent - samples) : 0;
}

void utterance_seek(struct utterance *t, size_t sentence, const char *mark) {
    while (t->segment_count)
        drop_segment(t);
    t->finished = false;
    synthesis_seek(t->source->text, sentence, mark, t->sent, 0);
}

void utterance_respeak(struct utterance *t) {
    /* keep a segment entered in the middle: it is the requested place */
    size_t held = t->segment_count && (t->sentence_said || t->segments[0].skip);
    uint32_t sample = t->sent;
    size_t next = t->segment_count ? t->segments[0].sentence : synthesis_next(t->source->text);
    if (held) {
        const struct media_segment *segment = &t->segments[0];
        next++;
        sample = (uint32_t)(segment->start + segment->audio->samples);
    }
    if (next == synthesis_sentences(t->source->text))
        return;
    for (size_t i = held; i < t->segment_count; i++)
        media_segment_free(&t->segments[i]);
    t->segment_count = held;
    t->finished = false;
    synthesis_seek(t->source->text, next, held ? NULL : synthesis_entry(t->source->text), sample, held);
}
