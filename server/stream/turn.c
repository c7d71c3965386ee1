/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/turn.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>

void turn_give(const struct turn *t, const struct stream_sink *sink, void *ctx, struct stream_event event) {
    event.utterance = t->utterance;
    event.id = t->speech ? speech_request(t->speech)->id : event.id;
    event.sample_rate = t->sample_rate;
    sink->event(ctx, &event);
}

void turn_add_scene(struct turn *t, struct scene scene) {
    t->scenes = mem_grow(t->scenes, &t->scene_cap, t->scene_count + 1, sizeof *t->scenes);
    t->scenes[t->scene_count++] = scene;
    t->length += (double)scene.utterance->samples / scene.utterance->sample_rate;
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
    speech_release(t->speech);
}

void turn_free(struct turn *t) {
    while (t->scene_count)
        drop_scene(t);
    speech_free(t->speech);
    mood_free(t->mood);
    free(t->scenes);
    free(t);
}

static struct stream_event place_of(struct turn *t, enum stream_event_kind kind, uint32_t from, uint32_t to,
                                    size_t start, size_t end) {
    const char *text = speech_request(t->speech)->text;
    size_t utf16_start = utf16_offset(&t->utf16, text, start);
    return (struct stream_event){.kind = kind,
                                 .sample = t->scenes[0].start + from,
                                 .duration = to - from,
                                 .start = start,
                                 .end = end,
                                 .utf16_start = utf16_start,
                                 .utf16_end = utf16_offset(&t->utf16, text, end),
                                 .text = text + start};
}

/* What begins before the cut and has not been said. */
static void say_events(struct turn *t, const struct stream_sink *sink, void *ctx) {
    const struct utterance *u = t->scenes[0].utterance;
    bool last = t->cut.at == u->samples;
    if (!t->sentence_said)
        turn_give(t, sink, ctx, place_of(t, STREAM_SENTENCE, 0, u->samples, u->from, u->to));
    t->sentence_said = true;
    for (; t->cut.word < u->word_count && (last || u->words[t->cut.word].start < t->cut.at); t->cut.word++) {
        const struct word *w = &u->words[t->cut.word];
        turn_give(t, sink, ctx, place_of(t, STREAM_WORD, w->start, w->end, w->from, w->to));
    }
    for (; t->cut.mark < u->mark_count && (last || u->marks[t->cut.mark].at < t->cut.at); t->cut.mark++) {
        const struct mark *m = &u->marks[t->cut.mark];
        turn_give(t, sink, ctx,
                  (struct stream_event){
                      .kind = STREAM_MARK, .sample = t->scenes[0].start + m->at, .text = m->name});
    }
}

void turn_cut(struct turn *t, const struct stream_sink *sink, void *ctx, struct chunk *chunk,
              struct fap_frame *frames) {
    const struct scene *scene = &t->scenes[0];
    uint32_t most = scene->utterance->sample_rate * STREAM_CHUNK_MS / 1000;
    cut_chunk(&t->cut, scene, speech_request(t->speech)->fps, most, chunk, frames);
    chunk->utterance = t->utterance;
    t->sent += chunk->samples;
    say_events(t, sink, ctx);
}
