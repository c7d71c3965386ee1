/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/turn.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

void turn_start(struct turn *t) {
    if (t->started)
        return;
    t->started = true;
    if (t->reel)
        reel_start(t->reel);
    else
        speech_start(t->speech);
}

double turn_fps(const struct turn *t) {
    return t->reel ? reel_fps(t->reel) : speech_request(t->speech)->fps;
}

static const char *id_of(const struct turn *t) {
    return t->reel ? reel_id(t->reel) : speech_request(t->speech)->id;
}

void turn_give(const struct turn *t, const struct stream_sink *sink, void *ctx, struct stream_event event) {
    event.utterance = t->utterance;
    event.id = t->speech || t->reel ? id_of(t) : event.id;
    event.sample_rate = t->sample_rate;
    sink->event(ctx, &event);
}

void turn_add_scene(struct turn *t, struct scene scene) {
    t->scenes = mem_grow(t->scenes, &t->scene_cap, t->scene_count + 1, sizeof *t->scenes);
    t->scenes[t->scene_count++] = scene;
    t->length += (double)(scene.utterance->samples - scene.skip) / scene.utterance->sample_rate;
}

static void drop_scene(struct turn *t) {
    scene_free(&t->scenes[0]);
    t->scene_count--;
    memmove(t->scenes, t->scenes + 1, t->scene_count * sizeof *t->scenes);
    t->cut = (struct cut){0};
    t->sentence_said = false;
}

void turn_drop_scene_if_done(struct turn *t) {
    if (t->cut.at < t->scenes[0].utterance->samples)
        return;
    drop_scene(t);
    if (t->reel)
        reel_release(t->reel);
    else
        speech_release(t->speech);
}

void turn_free(struct turn *t) {
    while (t->scene_count)
        drop_scene(t);
    speech_free(t->speech);
    reel_free(t->reel);
    mood_free(t->mood);
    free(t->scenes);
    free(t);
}

static struct stream_event place_of(struct turn *t, enum stream_event_kind kind, uint32_t from, uint32_t to,
                                    size_t start, size_t end) {
    const char *text = speech_request(t->speech)->text;
    size_t utf16_start = utf16_offset(&t->utf16, text, start);
    return (struct stream_event){.kind = kind,
                                 .sample = (uint32_t)(t->scenes[0].start + from),
                                 .duration = to - from,
                                 .start = start,
                                 .end = end,
                                 .utf16_start = utf16_start,
                                 .utf16_end = utf16_offset(&t->utf16, text, end),
                                 .text = text + start};
}

/* What begins before the cut and has not been said. */
static void say_events(struct turn *t, const struct stream_sink *sink, void *ctx) {
    const struct scene *scene = &t->scenes[0];
    const struct utterance *u = scene->utterance;
    bool last = t->cut.at == u->samples;
    if (!t->sentence_said && t->speech)
        turn_give(t, sink, ctx, place_of(t, STREAM_SENTENCE, scene->skip, u->samples, u->from, u->to));
    t->sentence_said = true;
    for (; t->cut.word < u->word_count && (last || u->words[t->cut.word].start < t->cut.at); t->cut.word++) {
        const struct word *w = &u->words[t->cut.word];
        turn_give(t, sink, ctx, place_of(t, STREAM_WORD, w->start, w->end, w->from, w->to));
    }
    bool phones = t->speech && speech_request(t->speech)->phones;
    for (; t->cut.phone < u->phone_count && (last || u->phones[t->cut.phone].start < t->cut.at);
         t->cut.phone++) {
        const struct phone *p = &u->phones[t->cut.phone];
        if (phones)
            turn_give(t, sink, ctx,
                      (struct stream_event){.kind = STREAM_PHONE,
                                            .sample = (uint32_t)(scene->start + p->start),
                                            .duration = p->end - p->start,
                                            .text = p->ipa});
    }
    for (; t->cut.mark < u->mark_count && (last || u->marks[t->cut.mark].at < t->cut.at); t->cut.mark++) {
        const struct mark *m = &u->marks[t->cut.mark];
        turn_give(t, sink, ctx,
                  (struct stream_event){
                      .kind = STREAM_MARK, .sample = (uint32_t)(scene->start + m->at), .text = m->name});
    }
}

void turn_cut(struct turn *t, const struct stream_sink *sink, void *ctx, struct chunk *chunk,
              struct fap_frame *frames) {
    const struct scene *scene = &t->scenes[0];
    uint32_t ms = t->sent ? STREAM_CHUNK_MS : STREAM_FIRST_MS;
    uint32_t most = (uint32_t)((uint64_t)scene->utterance->sample_rate * ms / 1000);
    if (!t->sentence_said)
        cut_enter(&t->cut, scene);
    cut_chunk(&t->cut, scene, turn_fps(t), most, chunk, frames);
    chunk->utterance = t->utterance;
    t->sent += chunk->samples;
    say_events(t, sink, ctx);
}

uint32_t turn_heard(const struct turn *t, uint64_t unheard) {
    uint64_t samples = unheard * t->sample_rate / 1000;
    return samples < t->sent ? (uint32_t)(t->sent - samples) : 0;
}

void turn_seek(struct turn *t, size_t sentence, const char *mark) {
    while (t->scene_count)
        drop_scene(t);
    t->length = t->sample_rate ? (double)t->sent / t->sample_rate : 0;
    t->finished = false;
    speech_seek(t->speech, sentence, mark, t->sent, 0);
}

void turn_respeak(struct turn *t) {
    /* one that is entered in its middle stays: what was asked for is that place */
    size_t held = t->scene_count && (t->sentence_said || t->scenes[0].skip);
    uint32_t sample = t->sent;
    size_t next = t->scene_count ? t->scenes[0].sentence : speech_next(t->speech);
    if (held) {
        const struct scene *scene = &t->scenes[0];
        next++;
        sample = (uint32_t)(scene->start + scene->utterance->samples);
    }
    if (next == speech_sentences(t->speech))
        return;
    for (size_t i = held; i < t->scene_count; i++)
        scene_free(&t->scenes[i]);
    t->scene_count = held;
    t->length = t->sample_rate ? (double)sample / t->sample_rate : 0;
    t->finished = false;
    speech_seek(t->speech, next, held ? NULL : speech_entry(t->speech), sample, held);
}

void turn_unplace(struct turn *t) {
    if (!t->started || !t->speech)
        return;
    t->placed = false;
    turn_seek(t, 0, NULL);
}
