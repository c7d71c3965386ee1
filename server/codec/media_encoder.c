/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/media_encoder.h"
#include "protocol/fapc.h"
#include "protocol/packed.h"
#include "server/base/mem.h"
#include "server/base/near.h"
#include "server/codec/opus_audio.h"
#include <stdlib.h>
#include <string.h>

enum { KILOBITS_LEAST = 6, KILOBITS_MOST = 64 };

struct encoder {
    struct encoding encoding;
    struct codec_load *codec_load;
    bool restart;
    struct fapc_encoder *fapc; /* NULL until there are frames: it is large, and many say nothing */
    struct compact compact;
    double since_begin;      /* s of media */
    struct opus_audio *opus; /* of the utterance */
    struct chunk utterance;  /* its number and rates */
    uint32_t packets;        /* of it so far */
    struct buf events;       /* to be said in the next chunk */
};

struct codec {
    const char *name;
    int codec;
};

static const struct codec audio_names[] = {{"none", CHUNK_AUDIO_SILENCE},
                                           {"pcm_s16le", CHUNK_AUDIO_PCM_S16LE},
                                           {"pcm", CHUNK_AUDIO_PCM_S16LE},
                                           {"opus", CHUNK_AUDIO_OPUS},
                                           {0}},
                          fap_names[] = {{"none", CHUNK_FAP_NONE},
                                         {"plain", CHUNK_FAP_PLAIN},
                                         {"fapc", CHUNK_FAP_FAPC},
                                         {0}};

const struct encoding encoding_default = {CHUNK_AUDIO_OPUS, CHUNK_FAP_FAPC, 0, false};
const struct encoding encoding_none = {CHUNK_AUDIO_SILENCE, CHUNK_FAP_NONE, 0, false};

static int find(const struct codec *list, const char *name, const char *field, struct error *e) {
    struct near near = near_to(name);
    char text[NEAR_TEXT];
    for (; list->name; list++) {
        if (!strcmp(list->name, name))
            return list->codec;
        near_try(&near, list->name, list->name);
    }
    return error_in_field(e, ERROR_UNKNOWN_CODEC, field, "no %s codec '%.80s'%s", field, name,
                          near_text(&near, text));
}

int encoding_audio(const char *name, struct error *e) {
    return find(audio_names, name, "audio", e);
}

int encoding_fap(const char *name, struct error *e) {
    return find(fap_names, name, "fap", e);
}

int encoding_kilobits(const char *number) {
    char *end;
    long value = strtol(number, &end, 10);
    return *number && !*end && value >= KILOBITS_LEAST && value <= KILOBITS_MOST ? (int)value : -1;
}

int encoding_events(const char *name) {
    return !strcmp(name, "packed") ? 1 : !strcmp(name, "text") ? 0 : -1;
}

bool encoding_same(const struct encoding *a, const struct encoding *b) {
    return a->audio == b->audio && a->fap == b->fap && a->kilobits == b->kilobits && a->packed == b->packed;
}

bool encoding_possible(const struct encoding *e) {
    return e->audio != CHUNK_AUDIO_OPUS || e->fap != CHUNK_FAP_PLAIN;
}

static bool is_compact(const struct encoding *e) {
    return e->audio == CHUNK_AUDIO_OPUS || e->fap == CHUNK_FAP_FAPC;
}

bool encoding_packs(const struct encoding *e, enum stream_event_kind kind) {
    return e->packed && is_compact(e) &&
           (kind == STREAM_SENTENCE || kind == STREAM_WORD || kind == STREAM_MARK || kind == STREAM_PHONE);
}

struct encoder *encoder_new(const struct encoding *encoding, struct codec_load *codec_load) {
    struct encoder *e = mem_alloc(sizeof *e);
    e->encoding = *encoding;
    e->codec_load = codec_load;
    e->restart = true;
    return e;
}

void encoder_free(struct encoder *e) {
    if (!e)
        return;
    opus_audio_free(e->opus);
    free(e->fapc);
    buf_free(&e->events);
    free(e);
}

void encoder_restart(struct encoder *e) {
    e->restart = true;
}

void encoder_event(struct encoder *e, const struct stream_event *event) {
    struct packed_event packed = {.sample = event->sample,
                                  .duration = event->duration,
                                  .start = (uint32_t)event->start,
                                  .utf16_start = (uint32_t)event->utf16_start,
                                  .text = event->text};
    bool placed = event->kind == STREAM_SENTENCE || event->kind == STREAM_WORD;
    packed.kind = event->kind == STREAM_SENTENCE ? PACKED_SENTENCE
                  : event->kind == STREAM_WORD   ? PACKED_WORD
                  : event->kind == STREAM_MARK   ? PACKED_MARK
                                                 : PACKED_PHONE;
    packed.size = (uint32_t)(placed ? event->end - event->start : strlen(event->text));
    e->events.size += packed_write(&packed, buf_reserve(&e->events, PACKED_HEAD_BYTES_MAX + packed.size));
}

/* Version 1: every chunk by itself. */
static struct encoded plain_chunk(const struct encoder *e, const struct chunk *chunk,
                                  const struct fap_frame *frames, struct buf *out) {
    struct chunk coded = *chunk;
    if (e->encoding.audio == CHUNK_AUDIO_SILENCE) {
        coded.audio_codec = CHUNK_AUDIO_SILENCE;
        coded.audio_bytes = 0;
    }
    if (e->encoding.fap == CHUNK_FAP_NONE) {
        coded.fap_codec = CHUNK_FAP_NONE;
        coded.frame_count = 0;
    }
    size_t cap = CHUNK_HEADER_BYTES + coded.audio_bytes + (size_t)coded.frame_count * CHUNK_FRAME_BYTES_MAX;
    size_t size = chunk_encode(&coded, frames, buf_reserve(out, cap), cap);
    out->size += size;
    return (struct encoded){true, coded.audio_bytes, size - coded.audio_bytes};
}

/* An utterance that has not been heard of: a new audio coder. */
static void meet_utterance(struct encoder *e, const struct chunk *chunk) {
    if (e->opus && chunk->utterance == e->utterance.utterance)
        return;
    opus_audio_free(e->opus);
    e->opus = opus_audio_new(chunk->sample_rate, e->encoding.kilobits * 1000u);
    e->packets = 0;
}

static void code_audio(struct encoder *e, const struct chunk *chunk, struct chunk *coded, struct buf *audio) {
    coded->audio_codec = CHUNK_AUDIO_SILENCE;
    coded->first_packet = 0;
    if (chunk->audio_codec == CHUNK_AUDIO_SILENCE || e->encoding.audio == CHUNK_AUDIO_SILENCE)
        return;
    if (e->encoding.audio == CHUNK_AUDIO_PCM_S16LE) {
        coded->audio_codec = CHUNK_AUDIO_PCM_S16LE;
        buf_add(audio, chunk->audio, chunk->audio_bytes);
        return;
    }
    meet_utterance(e, chunk);
    coded->audio_codec = CHUNK_AUDIO_OPUS;
    coded->first_packet = e->packets;
    if (!e->opus)
        return;
    opus_audio_set_level(e->opus, codec_load_now(e->codec_load));
    e->packets +=
        opus_audio_add(e->opus, (const int16_t *)(const void *)chunk->audio, chunk->audio_bytes / 2, audio);
}

/* FAP 1 and 2 say again, for simple decoders, what the others say; those who read this coding read all. */
static void code_frames(struct encoder *e, const struct fap_frame *frames, struct chunk *coded, bool begin,
                        struct buf *out) {
    struct fap_frame low[FAPC_FRAMES_MAX];
    coded->fap_codec = e->encoding.fap;
    if (coded->fap_codec == CHUNK_FAP_NONE) {
        coded->frame_count = 0;
        return;
    }
    if (!e->fapc) {
        e->fapc = mem_alloc(sizeof *e->fapc);
        fapc_encoder_init(e->fapc, FAPC_QUALITY);
    }
    size_t cap = ((size_t)coded->frame_count + 1) * FAPC_FRAME_BYTES_MAX;
    for (uint16_t i = 0; i < coded->frame_count; i++) {
        low[i] = frames[i];
        low[i].mask[0] &= (uint8_t)~3u;
    }
    out->size += fapc_encode(e->fapc, low, coded->frame_count, begin, buf_reserve(out, cap), cap);
}

static void put_compact(struct encoder *e, struct chunk *coded, bool begin, const struct buf *audio,
                        const struct buf *faps, struct buf *out) {
    coded->audio_bytes = (uint32_t)audio->size;
    coded->events_bytes = (uint32_t)e->events.size;
    out->size += compact_write(&e->compact, coded, begin, buf_reserve(out, COMPACT_HEADER_BYTES_MAX));
    if (e->events.size)
        buf_add(out, e->events.data, e->events.size);
    e->events.size = 0;
    buf_add(out, audio->data, audio->size);
    buf_add(out, faps->data, faps->size);
}

static bool begins(struct encoder *e, const struct chunk *chunk) {
    bool begin = e->restart || e->since_begin >= ENCODER_BEGIN_SECONDS;
    e->since_begin = (begin ? 0 : e->since_begin) + (double)chunk->samples / chunk->sample_rate;
    e->restart = false;
    return begin;
}

struct encoded encoder_chunk(struct encoder *e, const struct chunk *chunk, const struct fap_frame *frames,
                             struct buf *out) {
    if (!is_compact(&e->encoding))
        return plain_chunk(e, chunk, frames, out);
    struct chunk coded = *chunk;
    struct buf audio = {0}, faps = {0};
    bool begin = begins(e, chunk);
    code_audio(e, chunk, &coded, &audio);
    code_frames(e, frames, &coded, begin, &faps);
    put_compact(e, &coded, begin, &audio, &faps, out);
    if (chunk->utterance) /* the idle face may come in between, in a pause */
        e->utterance = *chunk;
    struct encoded result = {begin, audio.size, out->size - audio.size};
    buf_free(&audio);
    buf_free(&faps);
    return result;
}

void encoder_end(struct encoder *e, bool heard, struct buf *out) {
    struct buf audio = {0}, faps = {0};
    if (!e->opus)
        return;
    struct chunk coded = e->utterance;
    coded.start += coded.samples;
    coded.first_frame += coded.frame_count;
    coded.samples = coded.frame_count = 0;
    coded.audio_codec = CHUNK_AUDIO_OPUS;
    coded.fap_codec = CHUNK_FAP_NONE;
    coded.first_packet = e->packets;
    if (heard && opus_audio_end(e->opus, &audio))
        put_compact(e, &coded, false, &audio, &faps, out);
    buf_free(&audio);
    opus_audio_free(e->opus);
    e->opus = NULL;
}
