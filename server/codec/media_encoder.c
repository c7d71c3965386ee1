/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/media_encoder.h"
#include "protocol/chunk/chunk.h"
#include "protocol/chunk/compact.h"
#include "protocol/chunk/packed.h"
#include "protocol/fapc/fapc.h"
#include "server/base/mem.h"
#include "server/base/suggest.h"
#include "server/codec/coder_pool.h"
#include "server/codec/opus_audio.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { KILOBITS_LEAST = 6, KILOBITS_MOST = 64 };

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
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (; list->name; list++) {
        if (!strcmp(list->name, name))
            return list->codec;
        suggest_name(&near, list->name, list->name);
    }
    return error_in_field(e, ERROR_UNKNOWN_CODEC, field, "no %s codec '%.80s'%s", field, name,
                          suggestions_text(&near, text));
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

/* Tells whether compact chunks are used. */
static bool encoding_is_compact(const struct encoding *e) {
    return e->audio == CHUNK_AUDIO_OPUS || e->fap == CHUNK_FAP_FAPC;
}

bool encoding_packs(const struct encoding *e, enum stream_event_kind kind) {
    return e->packed && encoding_is_compact(e) &&
           (kind == STREAM_SENTENCE || kind == STREAM_WORD || kind == STREAM_MARK || kind == STREAM_PHONE);
}

struct media_coder {
    struct encoding encoding;
    struct fapc_encoder *fapc; /* NULL until there are frames: it is large, and many clients take none */
    struct compact compact;
    struct opus_audio *opus; /* of the utterance */
    struct chunk utterance;  /* its number and rates */
    uint32_t packets;        /* of it so far */
    struct buf audio, faps;  /* of a chunk; reused */
};

static struct media_coder *media_coder_new(const struct encoding *encoding) {
    struct media_coder *m = mem_alloc(sizeof *m);
    m->encoding = *encoding;
    return m;
}

static void media_coder_free(struct media_coder *m) {
    opus_audio_free(m->opus);
    free(m->fapc);
    buf_free(&m->audio);
    buf_free(&m->faps);
    free(m);
}

/* A chunk of version 1 is self-contained. */
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

/* Starts a new audio coder if the chunk begins a new utterance. */
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

/* Leaves out FAP 1 and 2, which repeat the other FAPs for simple decoders. */
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

/* Appends the message. */
static struct media_bytes media_coder_chunk(struct media_coder *m, const struct chunk *chunk,
                                            const struct fap_frame *frames, const struct media_terms *terms,
                                            struct buf *out) {
    if (!encoding_is_compact(&m->encoding))
        return plain_chunk(m, chunk, frames, out);
    struct chunk coded = *chunk;
    m->audio.size = m->faps.size = 0;
    code_audio(m, chunk, terms->level, &coded, &m->audio);
    code_frames(m, frames, &coded, terms->begin, &m->faps);
    put_compact(m, &coded, terms->begin, &terms->events, &m->audio, &m->faps, out);
    if (chunk->utterance) /* idle motion may come in between, during a pause */
        m->utterance = *chunk;
    return (struct media_bytes){m->audio.size, out->size - m->audio.size};
}

/* Ends the utterance. If it was heard to its end, appends a message with the audio coder's remaining
 * sound, if any. */
static void media_coder_end(struct media_coder *m, bool heard, const struct buf *events, struct buf *out) {
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

struct encoder {
    struct encoding encoding;
    struct codec_load *codec_load;
    struct coder_pool *coders;
    struct coder_line line;
    struct media_coder *coder; /* owned by the line's thread while jobs are pending */
    encoder_done *done;
    void *ctx;
    bool restart, freed;
    bool sounds;        /* the coder has received sound of the utterance */
    uint32_t utterance; /* of the last chunk that was not idle */
    double since_begin; /* s of media */
    struct buf events;  /* for the next chunk */
    struct buf out;     /* output of synchronous coding; reused */
    unsigned pending;   /* number of jobs */
};

/* A chunk, or the end of an utterance, coded on a thread. */
struct job {
    struct coder_job base; /* first member */
    struct encoder *encoder;
    void *tag;
    bool end, heard;
    struct media_terms terms;
    struct media_bytes bytes;
    struct buf out;
    struct chunk chunk;
    struct fap_frame frames[]; /* followed by the audio */
};

struct encoder *encoder_new(const struct encoding *encoding, struct coder_pool *coders,
                            struct codec_load *codec_load, encoder_done *done, void *ctx) {
    struct encoder *e = mem_alloc(sizeof *e);
    *e = (struct encoder){.encoding = *encoding,
                          .codec_load = codec_load,
                          .coders = coders,
                          .coder = media_coder_new(encoding),
                          .done = done,
                          .ctx = ctx,
                          .restart = true};
    return e;
}

static bool leave_out(struct coder_job *job) {
    (void)job;
    return true;
}

void encoder_free(struct encoder *e) {
    if (!e)
        return;
    if (e->pending && !e->freed)
        coder_pool_cancel(e->coders, &e->line, leave_out);
    e->freed = true;
    if (e->pending)
        return;
    media_coder_free(e->coder);
    buf_free(&e->events);
    buf_free(&e->out);
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

static bool begins(struct encoder *e, const struct chunk *chunk) {
    bool begin = e->restart || e->since_begin >= ENCODER_BEGIN_SECONDS;
    e->since_begin = (begin ? 0 : e->since_begin) + (double)chunk->samples / chunk->sample_rate;
    e->restart = false;
    return begin || !encoding_is_compact(&e->encoding);
}

static void tell(struct encoder *e, void *tag, const struct buf *out, bool begin, struct media_bytes bytes) {
    struct encoded encoded = {out->data, out->size, begin && out->size, bytes.audio, bytes.faps};
    e->done(e->ctx, tag, &encoded);
}

static void work(struct coder_job *base) {
    struct job *job = (struct job *)base;
    struct media_coder *coder = job->encoder->coder;
    if (job->end)
        media_coder_end(coder, job->heard, &job->terms.events, &job->out);
    else
        job->bytes = media_coder_chunk(coder, &job->chunk, job->frames, &job->terms, &job->out);
}

static void after_work(struct coder_job *base) {
    struct job *job = (struct job *)base;
    struct encoder *e = job->encoder;
    e->pending--;
    if (e->freed)
        encoder_free(e);
    else
        tell(e, job->tag, &job->out, job->terms.begin, job->bytes);
    buf_free(&job->terms.events);
    buf_free(&job->out);
    free(job);
}

static void submit(struct encoder *e, struct job *job, void *tag) {
    job->base.work = work;
    job->base.done = after_work;
    job->encoder = e;
    job->tag = tag;
    job->terms.events = e->events;
    e->events = (struct buf){0};
    e->pending++;
    coder_pool_submit(e->coders, &e->line, &job->base);
}

/* Copies the media, because the stream continues meanwhile. */
static void code_later(struct encoder *e, const struct chunk *chunk, const struct fap_frame *frames,
                       bool begin, bool urgent, void *tag) {
    size_t faces = chunk->frame_count * sizeof *frames;
    size_t sound = chunk->audio_codec == CHUNK_AUDIO_SILENCE ? 0 : chunk->audio_bytes;
    struct job *job = mem_resize(NULL, sizeof *job + faces + sound);
    *job = (struct job){.terms = {.begin = begin, .level = codec_load_now(e->codec_load)}, .chunk = *chunk};
    memcpy(job->frames, frames, faces);
    job->base.urgent = urgent; /* the start of an utterance is awaited */
    if (sound)
        job->chunk.audio = memcpy((uint8_t *)job->frames + faces, chunk->audio, sound);
    submit(e, job, tag);
}

/* PCM and plain FAPs. Little-endian: see meson.build. */
static struct chunk chunk_of(const struct media *media) {
    return (struct chunk){
        .audio_codec = media->pcm ? CHUNK_AUDIO_PCM_S16LE : CHUNK_AUDIO_SILENCE,
        .fap_codec = CHUNK_FAP_PLAIN,
        .utterance = media->utterance,
        .sample_rate = media->sample_rate,
        .fps_hundreds = (uint16_t)lround(media->fps * 100),
        .frame_count = (uint16_t)media->frame_count,
        .start = media->start,
        .samples = media->samples,
        .first_frame = media->first_frame,
        .audio_bytes = media->pcm ? media->samples * 2 : 0,
        .audio = (const uint8_t *)media->pcm,
    };
}

void encoder_media(struct encoder *e, const struct media *media, void *tag) {
    const struct chunk plain = chunk_of(media), *chunk = &plain;
    const struct fap_frame *frames = media->frames;
    bool opus = e->encoding.audio == CHUNK_AUDIO_OPUS && chunk->audio_codec != CHUNK_AUDIO_SILENCE;
    bool begin = begins(e, chunk), first = opus && !e->sounds;
    if (chunk->utterance)
        e->utterance = chunk->utterance;
    e->sounds |= opus;
    if (e->pending || (opus && e->coders)) {
        code_later(e, chunk, frames, begin, first, tag);
        return;
    }
    struct media_terms terms = {begin, codec_load_now(e->codec_load), e->events};
    e->out.size = 0;
    struct media_bytes bytes = media_coder_chunk(e->coder, chunk, frames, &terms, &e->out);
    e->events.size = 0;
    tell(e, tag, &e->out, begin, bytes);
}

/* Selects chunks of a stopped utterance; the next chunk becomes a starting point instead. */
static bool is_unheard(struct coder_job *base) {
    struct job *job = (struct job *)base;
    struct encoder *e = job->encoder;
    if (job->end || job->chunk.utterance != e->utterance)
        return false;
    e->restart |= job->terms.begin;
    return true;
}

void encoder_end(struct encoder *e, bool heard, void *tag) {
    if (e->pending && !heard)
        coder_pool_cancel(e->coders, &e->line, is_unheard);
    bool code = e->sounds;
    e->sounds = false;
    if (e->pending || (code && heard && e->coders)) {
        struct job *job = mem_alloc(sizeof *job);
        job->end = true;
        job->heard = heard;
        submit(e, job, tag);
        return;
    }
    e->out.size = 0;
    if (code)
        media_coder_end(e->coder, heard, &e->events, &e->out);
    if (e->out.size)
        e->events.size = 0;
    tell(e, tag, &e->out, false, (struct media_bytes){0});
}
