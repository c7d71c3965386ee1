/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/media_coder.h"
#include "protocol/compact.h"
#include "protocol/fapc.h"
#include "server/base/mem.h"
#include "server/codec/opus_audio.h"
#include <stdlib.h>
#include <string.h>

struct media_coder {
    struct encoding encoding;
    struct fapc_encoder *fapc; /* NULL until there are frames: it is large, and many say nothing */
    struct compact compact;
    struct opus_audio *opus; /* of the utterance */
    struct chunk utterance;  /* its number and rates */
    uint32_t packets;        /* of it so far */
    struct buf audio, faps;  /* of a chunk; kept for the next one */
};

struct media_coder *media_coder_new(const struct encoding *encoding) {
    struct media_coder *m = mem_alloc(sizeof *m);
    m->encoding = *encoding;
    return m;
}

void media_coder_free(struct media_coder *m) {
    opus_audio_free(m->opus);
    free(m->fapc);
    buf_free(&m->audio);
    buf_free(&m->faps);
    free(m);
}

/* Version 1: every chunk by itself. */
static struct media_bytes plain_chunk(const struct media_coder *m, const struct chunk *chunk,
                                      const struct fap_frame *frames, struct buf *out) {
    struct chunk coded = *chunk;
    if (m->encoding.audio == CHUNK_AUDIO_SILENCE) {
        coded.audio_codec = CHUNK_AUDIO_SILENCE;
        coded.audio_bytes = 0;
    }
    if (m->encoding.fap == CHUNK_FAP_NONE) {
        coded.fap_codec = CHUNK_FAP_NONE;
        coded.frame_count = 0;
    }
    size_t cap = CHUNK_HEADER_BYTES + coded.audio_bytes + (size_t)coded.frame_count * CHUNK_FRAME_BYTES_MAX;
    size_t size = chunk_encode(&coded, frames, buf_reserve(out, cap), cap);
    out->size += size;
    return (struct media_bytes){coded.audio_bytes, size - coded.audio_bytes};
}

/* An utterance that has not been heard of: a new audio coder. */
static void meet_utterance(struct media_coder *m, const struct chunk *chunk) {
    if (m->opus && chunk->utterance == m->utterance.utterance)
        return;
    opus_audio_free(m->opus);
    m->opus = opus_audio_new(chunk->sample_rate, m->encoding.kilobits * 1000u);
    m->packets = 0;
}

static void code_audio(struct media_coder *m, const struct chunk *chunk, unsigned level, struct chunk *coded,
                       struct buf *audio) {
    coded->audio_codec = CHUNK_AUDIO_SILENCE;
    coded->first_packet = 0;
    if (chunk->audio_codec == CHUNK_AUDIO_SILENCE || m->encoding.audio == CHUNK_AUDIO_SILENCE)
        return;
    if (m->encoding.audio == CHUNK_AUDIO_PCM_S16LE) {
        coded->audio_codec = CHUNK_AUDIO_PCM_S16LE;
        buf_add(audio, chunk->audio, chunk->audio_bytes);
        return;
    }
    meet_utterance(m, chunk);
    coded->audio_codec = CHUNK_AUDIO_OPUS;
    coded->first_packet = m->packets;
    if (!m->opus)
        return;
    opus_audio_set_level(m->opus, level);
    m->packets +=
        opus_audio_add(m->opus, (const int16_t *)(const void *)chunk->audio, chunk->audio_bytes / 2, audio);
}

/* FAP 1 and 2 say again, for simple decoders, what the others say; those who read this coding read all. */
static void code_frames(struct media_coder *m, const struct fap_frame *frames, struct chunk *coded,
                        bool begin, struct buf *out) {
    struct fap_frame low[FAPC_FRAMES_MAX];
    coded->fap_codec = m->encoding.fap;
    if (coded->fap_codec == CHUNK_FAP_NONE) {
        coded->frame_count = 0;
        return;
    }
    if (!m->fapc) {
        m->fapc = mem_alloc(sizeof *m->fapc);
        fapc_encoder_init(m->fapc, FAPC_QUALITY);
    }
    size_t cap = ((size_t)coded->frame_count + 1) * FAPC_FRAME_BYTES_MAX;
    for (uint16_t i = 0; i < coded->frame_count; i++) {
        low[i] = frames[i];
        low[i].mask[0] &= (uint8_t)~3u;
    }
    out->size += fapc_encode(m->fapc, low, coded->frame_count, begin, buf_reserve(out, cap), cap);
}

static void put_compact(struct media_coder *m, struct chunk *coded, bool begin, const struct buf *events,
                        const struct buf *audio, const struct buf *faps, struct buf *out) {
    coded->audio_bytes = (uint32_t)audio->size;
    coded->events_bytes = (uint32_t)events->size;
    out->size += compact_write(&m->compact, coded, begin, buf_reserve(out, COMPACT_HEADER_BYTES_MAX));
    buf_add(out, events->data, events->size);
    buf_add(out, audio->data, audio->size);
    buf_add(out, faps->data, faps->size);
}

struct media_bytes media_coder_chunk(struct media_coder *m, const struct chunk *chunk,
                                     const struct fap_frame *frames, const struct media_terms *terms,
                                     struct buf *out) {
    if (!encoding_is_compact(&m->encoding))
        return plain_chunk(m, chunk, frames, out);
    struct chunk coded = *chunk;
    m->audio.size = m->faps.size = 0;
    code_audio(m, chunk, terms->level, &coded, &m->audio);
    code_frames(m, frames, &coded, terms->begin, &m->faps);
    put_compact(m, &coded, terms->begin, &terms->events, &m->audio, &m->faps, out);
    if (chunk->utterance) /* the idle face may come in between, in a pause */
        m->utterance = *chunk;
    return (struct media_bytes){m->audio.size, out->size - m->audio.size};
}

void media_coder_end(struct media_coder *m, bool heard, const struct buf *events, struct buf *out) {
    if (!m->opus)
        return;
    struct chunk coded = m->utterance;
    coded.start += coded.samples;
    coded.first_frame += coded.frame_count;
    coded.samples = coded.frame_count = 0;
    coded.audio_codec = CHUNK_AUDIO_OPUS;
    coded.fap_codec = CHUNK_FAP_NONE;
    coded.first_packet = m->packets;
    m->audio.size = m->faps.size = 0;
    if (heard && opus_audio_end(m->opus, &m->audio))
        put_compact(m, &coded, false, events, &m->audio, &m->faps, out);
    opus_audio_free(m->opus);
    m->opus = NULL;
}
