/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/heard_voice.h"
#include "server/base/mem.h"
#include "server/synthesis/heard_voice_internal.h"
#include <stdlib.h>
#include <utlist.h>

static void problem(struct heard_voice *h, const struct error *e, bool warning) {
    h->callbacks.problem(h->ctx, e, warning);
}

static int choose(struct heard_voice *h, struct error *e) {
    const struct pipeline *pipeline = h->pipeline;
    const char *lang = h->request.lang ? h->request.lang : pipeline->default_lang;
    h->pack = speech_packs_find(pipeline->packs, lang);
    if (!h->pack)
        return error_in_field(e, ERROR_UNKNOWN_LANGUAGE, "lang", "no language '%s'", lang);
    if (!hear_face_speaks(h->request.engine, h->pack))
        return error_in_field(e, ERROR_UNKNOWN_ENGINE, "engine", "no engine '%s' for '%s'", h->request.engine,
                              lang);
    return 0;
}

static unsigned voices_of(const struct heard_pool *pool, uint32_t payer) {
    const struct heard_voice *other;
    unsigned count = 0;
    DL_FOREACH(pool->voices, other)
    count += payer && other->request.payer == payer;
    return count;
}

/* An engine by letters has nothing to go by: what it stands in for is another's. */
static int open_all(struct heard_voice *h, const struct heard_request *request, struct error *e) {
    const struct heard_pool *pool = h->pipeline->heard;
    if (!pool || !pool->network)
        return error_set(e, ERROR_VOICE_UNAVAILABLE, "this daemon has no models/hear/network.bin");
    if (heard_request_check(request, e) || choose(h, e))
        return -1;
    if (pool->count >= pool->most)
        return error_set(e, ERROR_TOO_MANY_VOICES, "%u voices are heard already", pool->count);
    if (pool->payer_most && voices_of(pool, h->request.payer) >= pool->payer_most)
        return error_set(e, ERROR_TOO_MANY_VOICES, "%u voices of one address or subject are heard already",
                         pool->payer_most);
    const struct hearing_options options = {.network = pool->network,
                                            .pack = h->pack,
                                            .engine = h->request.engine,
                                            .rate = request->rate,
                                            .channels = 1,
                                            .lookahead = request->lookahead,
                                            .fps = h->request.fps,
                                            .lives = !h->request.still && h->request.life != 0,
                                            .frame = heard_frame,
                                            .ctx = h};
    h->hearing = hearing_new(&options, e);
    if (!h->hearing || !(h->sound = heard_sound_new(request, e)))
        return -1;
    heard_pace_open(&h->pace, h->rate, (size_t)h->rate * pool->seconds);
    return 0;
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

static void stop_timer(struct heard_voice *h) {
    if (h->timer)
        uv_close((uv_handle_t *)h->timer, free_timer);
    h->timer = NULL;
}

static void free_all(struct heard_voice *h) {
    hearing_free(h->hearing);
    heard_sound_free(h->sound);
    heard_pace_free(&h->pace);
    request_free(&h->request);
    free(h->pcm);
    free(h->frames);
    free(h);
}

static uint64_t most_silence(const struct heard_voice *h) {
    return (uint64_t)h->pipeline->open_seconds * 1000;
}

/* Those who wait get their turn, too. */
static void on_timer(uv_timer_t *timer) {
    struct heard_voice *h = timer->data;
    uint64_t silent = uv_now(h->pipeline->loop) - h->last;
    struct error e;
    if (silent < most_silence(h)) {
        uv_timer_start(timer, on_timer, most_silence(h) - silent, 0);
        return;
    }
    error_set(&e, ERROR_UNFINISHED,
              h->fresh ? "too little was heard of it in %u s" : "nothing was heard of it for %u s",
              h->pipeline->open_seconds);
    problem(h, &e, true);
    heard_voice_close(h);
}

struct heard_voice *heard_voice_open(const struct pipeline *pipeline, const struct heard_request *request,
                                     const struct synthesis_callbacks *callbacks, void *ctx,
                                     struct error *e) {
    struct heard_voice *h = mem_alloc(sizeof *h);
    *h = (struct heard_voice){.pipeline = pipeline,
                              .callbacks = *callbacks,
                              .ctx = ctx,
                              .rate = request->rate,
                              .lookahead = request->lookahead,
                              .last = uv_now(pipeline->loop)};
    request_copy(&h->request, request->speech);
    if (open_all(h, request, e)) {
        free_all(h);
        return NULL;
    }
    pipeline->heard->count++;
    DL_APPEND(pipeline->heard->voices, h);
    h->timer = mem_alloc(sizeof *h->timer);
    uv_timer_init(pipeline->loop, h->timer);
    h->timer->data = h;
    if (most_silence(h))
        uv_timer_start(h->timer, on_timer, most_silence(h), 0);
    return h;
}

void heard_voice_free(struct heard_voice *h) {
    if (!h)
        return;
    stop_timer(h);
    h->pipeline->heard->count--;
    DL_DELETE(h->pipeline->heard->voices, h);
    free_all(h);
}

void heard_voice_start(struct heard_voice *h) {
    h->started = true;
    heard_voice_catch_up(h);
    heard_deliver(h);
}

void heard_voice_catch_up(struct heard_voice *h) {
    heard_pace_catch_up(&h->pace);
    heard_pace_begin(&h->pace);
}

/* Said once: who is too fast is so again and again. What waits for its turn is passed over all the same. */
static void on_samples(void *ctx, const int16_t *samples, size_t count) {
    struct heard_voice *h = ctx;
    h->fresh += count;
    if (h->fresh * 100 >= (uint64_t)h->rate * h->pipeline->open_seconds * HEARD_LEAST_PERCENT) {
        h->last = uv_now(h->pipeline->loop);
        h->fresh = 0;
    }
    size_t out = heard_pace_add(&h->pace, samples, count, (double)uv_hrtime() / 1e9);
    struct error e;
    if (h->started)
        heard_deliver(h);
    if (!out || !h->started || h->told_skip)
        return;
    h->told_skip = true;
    error_set(&e, ERROR_SKIPPED, "it comes faster than it can be heard: more than %u s of it waited",
              h->pipeline->heard->seconds);
    problem(h, &e, true);
}

void heard_voice_write(struct heard_voice *h, const uint8_t *bytes, size_t size) {
    struct error e;
    if (h->closed)
        return;
    if (h->stalled)
        heard_pace_begin(&h->pace);
    h->stalled = false;
    if (heard_sound_read(h->sound, bytes, size, on_samples, h, &e) && !h->told_bad) {
        h->told_bad = true;
        problem(h, &e, true);
    }
    if (!heard_voice_awaits(h))
        heard_voice_close(h);
}

void heard_voice_close(struct heard_voice *h) {
    struct error e;
    if (h->closed)
        return;
    h->closed = true;
    stop_timer(h);
    if (heard_sound_end(h->sound, &e))
        problem(h, &e, true);
    if (h->started)
        heard_deliver(h);
}

bool heard_voice_is_open(const struct heard_voice *h) {
    return !h->closed;
}

/* The clock counts no further than that. */
bool heard_voice_awaits(const struct heard_voice *h) {
    return !h->closed && h->given < UINT32_MAX / 2;
}

void heard_voice_release(struct heard_voice *h) {
    h->released++;
    heard_deliver(h);
}

const struct speech_request *heard_voice_request(const struct heard_voice *h) {
    return &h->request;
}

const char *heard_voice_lang(const struct heard_voice *h) {
    return h->request.lang && speech_pack_is_general(h->pack) ? h->request.lang : speech_pack_lang(h->pack);
}

const char *heard_voice_engine(const struct heard_voice *h) {
    return h->request.engine ? h->request.engine : HEAR_ENGINE;
}

unsigned heard_voice_lookahead(const struct heard_voice *h) {
    return h->lookahead;
}

bool heard_voice_stalls(const struct heard_voice *h) {
    return h->stalled;
}
