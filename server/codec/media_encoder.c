/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/media_encoder.h"
#include "protocol/compact.h"
#include "protocol/packed.h"
#include "server/base/mem.h"
#include "server/codec/coder_pool.h"
#include "server/codec/media_coder.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct encoder {
    struct encoding encoding;
    struct codec_load *codec_load;
    struct coder_pool *coders;
    struct coder_line line;
    struct media_coder *coder; /* of the line's thread while jobs are pending */
    encoder_done *done;
    void *ctx;
    bool restart, freed;
    bool sounds;        /* the coder has had sound of the utterance */
    uint32_t utterance; /* of the last chunk that was none of idling */
    double since_begin; /* s of media */
    struct buf events;  /* to be said in the next chunk */
    struct buf out;     /* of what is coded at once; kept for the next one */
    unsigned pending;   /* jobs */
};

/* A chunk, or the end of an utterance, on its way through another thread. */
struct job {
    struct coder_job base; /* first */
    struct encoder *encoder;
    void *tag;
    bool end, heard;
    struct media_terms terms;
    struct media_bytes bytes;
    struct buf out;
    struct chunk chunk;
    struct fap_frame frames[]; /* and then its audio */
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

/* What it codes is the stream's, which goes on meanwhile: it is copied. */
static void code_later(struct encoder *e, const struct chunk *chunk, const struct fap_frame *frames,
                       bool begin, bool urgent, void *tag) {
    size_t faces = chunk->frame_count * sizeof *frames;
    size_t sound = chunk->audio_codec == CHUNK_AUDIO_SILENCE ? 0 : chunk->audio_bytes;
    struct job *job = mem_resize(NULL, sizeof *job + faces + sound);
    *job = (struct job){.terms = {.begin = begin, .level = codec_load_now(e->codec_load)}, .chunk = *chunk};
    memcpy(job->frames, frames, faces);
    job->base.urgent = urgent; /* somebody waits for an utterance's first sound */
    if (sound)
        job->chunk.audio = memcpy((uint8_t *)job->frames + faces, chunk->audio, sound);
    submit(e, job, tag);
}

/* Samples and frames as PCM and plain FAPs. Little-endian: see meson.build. */
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

/* Of a chunk of the utterance that has been stopped. The one after it is begun with in its place. */
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
