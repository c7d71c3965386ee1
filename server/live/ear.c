/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/ear.h"
#include "server/base/mem.h"
#include "server/live/opus_process.h"
#include "server/synthesis/pipeline.h"
#include <soxr.h>
#include <stdlib.h>
#include <utlist.h>

enum { BLOCK = 4096 };

struct ear {
    const struct pipeline *pipeline;
    const struct ear_calls *calls;
    void *ctx;
    uint32_t quota_key;
    struct live_audio *sound;
    struct opus_process *opus;       /* decodes the packets; NULL = PCM, or `sound` decodes them */
    soxr_t resampler;                /* NULL: the sound has RECOGNITION_RATE */
    struct recognition *recognition; /* NULL once it is done */
    uv_timer_t *timer;               /* NULL once the utterance is closed */
    uint64_t samples;                /* given to the recogniser */
    bool closed, ended, told_bad;
    struct ear *prev, *next; /* in the pool's list */
};

static void tell_bad(struct ear *ear, const struct error *e) {
    if (!ear->told_bad)
        ear->calls->warning(ear->ctx, e);
    ear->told_bad = true;
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

static void stop_timer(struct ear *ear) {
    if (ear->timer)
        uv_close((uv_handle_t *)ear->timer, free_timer);
    ear->timer = NULL;
}

/* Closes an utterance that lasts too long. */
static void close_late(struct ear *ear) {
    struct error e;
    error_set(&e, ERROR_UNFINISHED, "an utterance may last %u s", ear->pipeline->ears->seconds);
    ear->calls->warning(ear->ctx, &e);
    ear_close(ear);
}

static void on_timer(uv_timer_t *timer) {
    close_late(timer->data);
}

/* Gives the recogniser samples at its rate, up to the limit. */
static void give(struct ear *ear, const int16_t *samples, size_t count) {
    const uint64_t most = (uint64_t)ear->pipeline->ears->seconds * RECOGNITION_RATE;
    const size_t fits = ear->samples + count < most ? count : (size_t)(most - ear->samples);
    ear->samples += fits;
    if (fits)
        ear->calls->samples(ear->ctx, samples, fits);
    if (ear->recognition)
        recognition_write(ear->recognition, samples, fits);
}

static void on_samples(void *ctx, const int16_t *samples, size_t count) {
    struct ear *ear = ctx;
    int16_t block[BLOCK];
    if (!ear->resampler) {
        give(ear, samples, count);
        return;
    }
    for (size_t used = 1, made = 1; count || used || made;) {
        soxr_process(ear->resampler, samples, count, &used, block, BLOCK, &made);
        give(ear, block, made);
        samples += used;
        count -= used;
        if (!used && !made)
            break;
    }
}

/* Gives what the resampler still holds, and ends the recogniser's input. */
static void end_sound(struct ear *ear) {
    int16_t block[BLOCK];
    size_t made = ear->resampler ? 1 : 0;
    ear->ended = true;
    while (made) {
        soxr_process(ear->resampler, NULL, 0, NULL, block, BLOCK, &made);
        give(ear, block, made);
    }
    ear->calls->samples(ear->ctx, NULL, 0);
    if (ear->recognition)
        recognition_end(ear->recognition);
}

static void check(struct ear *ear) {
    if (!ear->closed && ear->samples >= (uint64_t)ear->pipeline->ears->seconds * RECOGNITION_RATE)
        close_late(ear);
    else if (ear->closed && !ear->ended && !(ear->opus && opus_process_waits(ear->opus)))
        end_sound(ear);
}

static void on_packet(void *ctx, const int16_t *samples, size_t frames, int status, uint64_t at) {
    struct ear *ear = ctx;
    struct error e;
    on_samples(ear, samples, frames);
    if (status) {
        error_at_byte(&e, ERROR_BAD_SOUND, (size_t)at, "invalid Opus packet");
        tell_bad(ear, &e);
    }
    check(ear);
}

static void on_decoder_failed(void *ctx, const char *why) {
    struct ear *ear = ctx;
    struct error e;
    error_set(&e, ERROR_BAD_SOUND, "the Opus decoder %s", why);
    tell_bad(ear, &e);
    ear_close(ear);
    check(ear);
}

static void on_words(void *ctx, const struct heard_words *words) {
    const struct ear *ear = ctx;
    ear->calls->words(ear->ctx, words);
}

/* `done` may free the ear. */
static void on_done(void *ctx, const struct heard_words *words, const struct error *e) {
    struct ear *ear = ctx;
    ear->recognition = NULL;
    ear->closed = ear->ended = true;
    stop_timer(ear);
    ear->calls->done(ear->ctx, words, e);
}

static unsigned ears_of(const struct ear_pool *pool, uint32_t quota_key) {
    const struct ear *other;
    unsigned count = 0;
    DL_FOREACH(pool->ears, other)
    count += quota_key && other->quota_key == quota_key;
    return count;
}

/* Opus is decoded at the recogniser's rate; packets, which are untrusted, in a separate process if a program
 * for it is configured. */
static int open_sound(struct ear *ear, const struct live_request *request, struct error *e) {
    static const struct opus_process_calls calls = {on_packet, on_decoder_failed};
    const struct reader *reader = ear->pipeline->reader;
    struct live_request format = *request;
    const bool apart = request->codec == LIVE_OPUS && reader && reader->program && *reader->program;
    if (request->codec == LIVE_OPUS)
        format.rate = RECOGNITION_RATE;
    if (apart)
        format.channels = 1;
    if (apart && !(ear->opus = opus_process_new(ear->pipeline->loop, reader, format.rate, format.channels,
                                                &calls, ear, e)))
        return -1;
    if (!apart && !(ear->sound = live_audio_new(&format, e)))
        return -1;
    if (format.rate != RECOGNITION_RATE) {
        const soxr_io_spec_t io = soxr_io_spec(SOXR_INT16_I, SOXR_INT16_I);
        const soxr_quality_spec_t quality = soxr_quality_spec(SOXR_MQ, 0);
        ear->resampler = soxr_create(format.rate, RECOGNITION_RATE, 1, NULL, &io, &quality, NULL);
    }
    return 0;
}

static int open_all(struct ear *ear, const struct live_request *request, struct error *e) {
    static const struct recognition_calls calls = {on_words, on_done};
    const struct ear_pool *pool = ear->pipeline->ears;
    const char *lang = request->speech->lang ? request->speech->lang : ear->pipeline->default_lang;
    if (!pool || !pool->recogniser.how)
        return error_plain(e, ERROR_NO_RECOGNISER);
    if (live_request_check(request, e))
        return -1;
    if (pool->count >= pool->most)
        return error_set(e, ERROR_TOO_MANY_VOICES, "%u utterances are being heard already", pool->count);
    if (pool->key_most && ears_of(pool, ear->quota_key) >= pool->key_most)
        return error_set(e, ERROR_TOO_MANY_VOICES,
                         "%u utterances of one address or subject are being heard already", pool->key_most);
    if (open_sound(ear, request, e))
        return -1;
    ear->recognition = recognition_start(ear->pipeline->loop, &pool->recogniser, lang,
                                         request->room ? request->room : "", &calls, ear, e);
    return ear->recognition ? 0 : -1;
}

static void free_all(struct ear *ear) {
    recognition_free(ear->recognition);
    opus_process_free(ear->opus);
    live_audio_free(ear->sound);
    if (ear->resampler)
        soxr_delete(ear->resampler);
    free(ear);
}

struct ear *ear_open(const struct pipeline *pipeline, const struct live_request *request,
                     const struct ear_calls *calls, void *ctx, struct error *e) {
    struct ear *ear = mem_alloc(sizeof *ear);
    *ear = (struct ear){
        .pipeline = pipeline, .calls = calls, .ctx = ctx, .quota_key = request->speech->quota_key};
    if (open_all(ear, request, e)) {
        free_all(ear);
        return NULL;
    }
    pipeline->ears->count++;
    DL_APPEND(pipeline->ears->ears, ear);
    ear->timer = mem_alloc(sizeof *ear->timer);
    uv_timer_init(pipeline->loop, ear->timer);
    ear->timer->data = ear;
    uv_timer_start(ear->timer, on_timer, (uint64_t)pipeline->ears->seconds * 1000, 0);
    return ear;
}

void ear_sound(struct ear *ear, const uint8_t *bytes, size_t size) {
    struct error e;
    if (ear->closed)
        return;
    if (ear->opus) {
        if (!opus_process_write(ear->opus, bytes, size)) {
            error_set(&e, ERROR_SKIPPED, "sound arrives faster than it can be decoded");
            tell_bad(ear, &e);
        }
        return;
    }
    if (live_audio_read(ear->sound, bytes, size, on_samples, ear, &e))
        tell_bad(ear, &e);
    check(ear);
}

void ear_close(struct ear *ear) {
    if (ear->closed)
        return;
    ear->closed = true;
    stop_timer(ear);
    check(ear);
}

bool ear_is_open(const struct ear *ear) {
    return !ear->closed;
}

void ear_free(struct ear *ear) {
    if (!ear)
        return;
    stop_timer(ear);
    ear->pipeline->ears->count--;
    DL_DELETE(ear->pipeline->ears->ears, ear);
    free_all(ear);
}
