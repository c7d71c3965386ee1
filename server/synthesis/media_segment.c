/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/media_segment.h"
#include "server/base/mem.h"
#include "server/face/track.h"
#include "server/synthesis/bell.h"
#include "server/synthesis/synthesis_internal.h"
#include "server/voice/sentence_audio.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

void media_segment_free(struct media_segment *segment) {
    sentence_audio_free(segment->audio);
    face_track_free(segment->track);
    free(segment->own);
    *segment = (struct media_segment){0};
}

struct face_placement *media_segment_place(const struct media_segment *segment,
                                           const struct placement_options *options) {
    if (segment->mouth)
        return face_placement_new(NULL, NULL, options);
    return segment->track ? face_placement_new(segment->track, segment->audio, options) : NULL;
}

static const struct fap_frame *frame_of(const struct media_segment *segment, uint32_t k) {
    static const struct fap_frame rest;
    size_t at = k > segment->first_frame ? k - segment->first_frame : 0;
    if (!segment->frame_count)
        return &rest;
    return &segment->frames[at < segment->frame_count ? at : segment->frame_count - 1];
}

void media_segment_frame(const struct media_segment *segment, struct face_placement *placement, double fps,
                         uint32_t k, struct fap_frame *frame) {
    if (!placement) {
        *frame = *frame_of(segment, k);
        return;
    }
    if (segment->mouth) {
        face_placement_sample_around(placement, k / fps, frame_of(segment, k), frame);
        return;
    }
    face_placement_frame(placement, k / fps - (double)segment->start / segment->audio->sample_rate, 1 / fps,
                         frame);
}

uint32_t frame_from_sample(uint64_t sample, uint32_t sample_rate, double fps) {
    /* the protocol counts frame rates in hundredths, so this is exact */
    uint64_t hundredths = (uint64_t)llround(fps * 100), per = 100 * (uint64_t)sample_rate;
    return (uint32_t)((sample * hundredths + per - 1) / per);
}

/* Makes a segment from a sentence's audio. */

static void warn(void *ctx, const char *message) {
    struct synthesis *s = ctx;
    struct error e;
    error_set(&e, ERROR_VOICE_WARNING, "%s", message);
    if (!s->freed)
        s->callbacks.problem(s->ctx, &e, true);
}

/* Chooses the language pack of the voice for the lips, if there is one for the engine. */
static const struct speech_pack *pack_of(const struct synthesis *s, const struct sentence_audio *u) {
    const struct speech_pack *own = speech_packs_spoken(s->pipeline->packs, s->pack, u->lang);
    if (u->mixed)
        own = speech_packs_cover(s->pipeline->packs, own ? own : s->pack, u);
    return own && face_engine_speaks(synthesis_engine(s), own) ? own : s->pack;
}

static double second_of(const struct synthesis *s, const struct sentence_audio *u, uint32_t skip) {
    return ((double)s->samples - skip) / u->sample_rate;
}

/* Makes the slot's face track. Audio and track must not change afterwards. */
static void make_track(struct synthesis *s, struct slot *slot, uint32_t skip) {
    struct sentence_audio *u = slot->audio;
    const struct face_options options = {.engine = s->request.engine,
                                         .still = s->request.still,
                                         .blend = s->result.blend,
                                         .contacts = s->request.contacts,
                                         .expressions = s->expressions};
    for (size_t i = 0; i < u->warning_count; i++)
        warn(s, u->warnings[i]);
    cues_add_timed(u, s->score, second_of(s, u, skip));
    slot->track = face_track_new(pack_of(s, u), u, &options, warn, s);
    if (s->keeps && s->result.marks && !slot->wait)
        kept_speech_add(&s->kept, &(struct kept_sentence){slot->sentence, u, slot->track});
}

struct media_segment synthesis_segment(struct synthesis *s, struct slot *slot) {
    struct sentence_audio *u = slot->audio;
    const struct speech_request *r = &s->request;
    uint32_t skip = sentence_audio_mark(u, s->entry);
    if (!slot->track)
        make_track(s, slot, skip);
    struct media_segment segment = {.audio = u,
                                    .track = slot->track,
                                    .start = (int64_t)s->samples - skip,
                                    .skip = skip,
                                    .sentence = slot->sentence,
                                    .wait = slot->wait,
                                    .alone = {.still = r->still,
                                              .life = r->life < 0 ? 1 : r->life,
                                              .seed = r->seed < 0 ? 0 : (uint64_t)r->seed,
                                              .begin = second_of(s, u, skip)}};
    s->sample_rate = u->sample_rate;
    s->samples += u->samples - skip;
    return segment;
}

void synthesis_prepare(const struct synthesis *s, struct sentence_audio *u) {
    if (s->sample_rate)
        sentence_audio_resample(u, s->sample_rate);
    sentence_audio_lead_in(u, lead_in_missing(pack_of(s, u), u));
}

static struct sentence_audio *quiet(const struct synthesis *s, unsigned ms) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    u->sample_rate = s->sample_rate;
    u->samples = (uint32_t)((uint64_t)s->sample_rate * ms / 1000);
    u->pcm = mem_alloc(((size_t)u->samples + 1) * sizeof *u->pcm);
    u->phones = mem_alloc(sizeof *u->phones);
    u->phones[u->phone_count++] = (struct phone){.sampa = "_", .end = u->samples};
    memccpy(u->lang, synthesis_lang(s), '\0', sizeof u->lang - 1);
    return u;
}

struct media_segment synthesis_wait(struct synthesis *s, unsigned ms) {
    struct slot slot = {.synthesis = s, .audio = quiet(s, ms), .sentence = s->delivered, .wait = true};
    return synthesis_segment(s, &slot);
}

struct media_segment synthesis_bell(struct synthesis *s, const struct slot *before) {
    s->sample_rate = before->audio->sample_rate;
    struct slot slot = {
        .synthesis = s, .audio = quiet(s, BELL_MS), .sentence = before->sentence, .wait = true};
    bell_ring(slot.audio->pcm, slot.audio->samples, s->sample_rate, s->request.volume);
    return synthesis_segment(s, &slot);
}

/* Estimate for a track: six curves with a segment per phone. */
enum { BYTES_PER_PHONE = 1024 };
static size_t size_of(const struct kept_sentence *k) {
    return (size_t)k->audio->samples * 2 + k->audio->phone_count * BYTES_PER_PHONE;
}

static void drop(struct kept_speech *kept, size_t i) {
    struct kept_sentence *k = &kept->items[i];
    kept->bytes -= size_of(k);
    sentence_audio_free(k->audio);
    face_track_free(k->track);
    memmove(k, k + 1, (--kept->count - i) * sizeof *k);
}

void kept_speech_add(struct kept_speech *kept, const struct kept_sentence *sentence) {
    for (size_t i = 0; i < kept->count; i++)
        if (kept->items[i].sentence == sentence->sentence) {
            drop(kept, i);
            break;
        }
    if (size_of(sentence) > KEPT_SPEECH_BYTES)
        return;
    while (kept->bytes + size_of(sentence) > KEPT_SPEECH_BYTES)
        drop(kept, 0);
    kept->items = mem_grow(kept->items, &kept->cap, kept->count + 1, sizeof *kept->items);
    kept->items[kept->count++] = (struct kept_sentence){.sentence = sentence->sentence,
                                                        .audio = sentence_audio_share(sentence->audio),
                                                        .track = face_track_share(sentence->track)};
    kept->bytes += size_of(sentence);
}

const struct kept_sentence *kept_speech_find(const struct kept_speech *kept, size_t sentence) {
    for (size_t i = 0; i < kept->count; i++)
        if (kept->items[i].sentence == sentence)
            return &kept->items[i];
    return NULL;
}

void kept_speech_clear(struct kept_speech *kept) {
    while (kept->count)
        drop(kept, kept->count - 1);
    free(kept->items);
    *kept = (struct kept_speech){0};
}
