/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/live_voice.h"
#include "server/base/mem.h"
#include "server/base/sound/mixdown.h"
#include "server/live/jitter_buffer.h"
#include "server/live/lip_recogniser.h"
#include "server/live/opus_process.h"
#include "server/synthesis/media_segment.h"
#include "server/synthesis/pipeline.h"
#include "server/voice/sentence_audio.h"
#include <math.h>
#include <opus/opus.h>
#include <stdlib.h>
#include <string.h>
#include <utlist.h>

struct live_voice {
    struct speech_source base;
    const struct pipeline *pipeline;
    struct synthesis_callbacks callbacks;
    void *ctx;
    struct speech_request request;
    const struct speech_pack *pack;
    unsigned rate, lookahead;
    struct live_audio *sound;
    struct opus_process *opus; /* decodes the packets; NULL = PCM, or `sound` decodes them */
    struct jitter_buffer jitter;
    struct lip_recogniser *recogniser;
    uv_timer_t *timer;              /* NULL once it is closed */
    uint64_t last;                  /* loop time, ms, when LIVE_MIN_PERCENT of real time was last reached */
    uint64_t fresh;                 /* samples since `last` */
    struct live_voice *prev, *next; /* in the pool's list */
    bool started, closed, recognised_all, finished;
    bool stalled; /* silence was inserted since the last sound */
    bool told_skip, told_bad;
    int16_t *pcm; /* recognised but not delivered; the first sample is number `given` */
    size_t pcm_count, pcm_cap;
    struct fap_frame *frames; /* their frames, starting with number first_frame */
    size_t frame_count, frame_cap;
    uint32_t first_frame;
    uint32_t given; /* samples delivered */
    size_t handed, released;
};

/* Makes segments from sound whose frames are known. */

enum { BLOCKS_A_SECOND = 100, AHEAD_BLOCKS = 50 };

/* Callback of the lip recogniser. */
static void live_frame(void *ctx, uint32_t k, const struct fap_frame *frame) {
    struct live_voice *h = ctx;
    (void)k; /* frames come in order */
    h->frames = mem_grow(h->frames, &h->frame_cap, h->frame_count + 1, sizeof *frame);
    h->frames[h->frame_count++] = *frame;
}

/* Feeds samples to the lip recogniser. */
static void live_recognise(struct live_voice *h, const int16_t *samples, size_t count) {
    float block[LIVE_RATE_MAX / BLOCKS_A_SECOND];
    h->pcm = mem_grow(h->pcm, &h->pcm_cap, h->pcm_count + count, sizeof *samples);
    memcpy(h->pcm + h->pcm_count, samples, count * sizeof *samples);
    h->pcm_count += count;
    for (size_t i = 0; i < count; i++)
        block[i] = (float)samples[i] / 32768;
    lip_recogniser_write(h->recogniser, block, count);
}

/* Tells whether packets are still being decoded. */
static bool decodes(const struct live_voice *h) {
    return h->opus && opus_process_waits(h->opus);
}

/* Recognises only what is needed soon: the rest stays in the jitter buffer, where it can be dropped. */
static void recognise_ahead(struct live_voice *h) {
    int16_t block[LIVE_RATE_MAX / BLOCKS_A_SECOND];
    size_t size = h->rate / BLOCKS_A_SECOND, count;
    size_t most = size * AHEAD_BLOCKS + (size_t)(h->rate / h->request.fps);
    while (!h->recognised_all && h->pcm_count < most && (count = jitter_buffer_take(&h->jitter, block, size)))
        live_recognise(h, block, count);
    if (h->closed && !decodes(h) && !h->recognised_all && h->pcm_count < most) {
        lip_recogniser_end(h->recogniser);
        h->recognised_all = true;
    }
}

/* Returns the size of the next segment in samples; 0 = not enough yet. */
static size_t piece_size(const struct live_voice *h) {
    size_t known = h->pcm_count, most = (size_t)h->rate * LIVE_PIECE_MAX_MS / 1000;
    double end = (double)(h->first_frame + h->frame_count) / h->request.fps * h->rate - h->given;
    if (!h->recognised_all && end < (double)known)
        known = end > 0 ? (size_t)end : 0;
    if (!h->recognised_all && known < (size_t)h->rate * LIVE_PIECE_MS / 1000)
        return 0;
    return known < most ? known : most;
}

static void *copy_of(const void *from, size_t size) {
    return memcpy(mem_alloc(size), from, size);
}

/* Delivers a segment with its frames, at least one; the last frame is repeated. */
static void pass_on(struct live_voice *h, size_t size) {
    uint32_t next = frame_from_sample((uint64_t)h->given + size, h->rate, h->request.fps);
    size_t used = next > h->first_frame ? next - h->first_frame : 0;
    used = used < h->frame_count ? used : h->frame_count;
    struct media_segment segment = {
        .audio = mem_alloc(sizeof *segment.audio),
        .start = h->given,
        .sentence = h->handed++,
        .mouth = true,
        .alone = {.still = h->request.still, .life = h->request.life >= 0 ? h->request.life : 1},
        .first_frame = h->first_frame,
        .frame_count = used};
    *segment.audio = (struct sentence_audio){
        .sample_rate = h->rate, .pcm = copy_of(h->pcm, size * sizeof *h->pcm), .samples = (uint32_t)size};
    segment.own = used ? copy_of(h->frames, used * sizeof *h->frames) : NULL;
    segment.frames = segment.own;
    h->given += (uint32_t)size;
    h->pcm_count -= size;
    memmove(h->pcm, h->pcm + size, h->pcm_count * sizeof *h->pcm);
    h->frame_count -= used;
    h->first_frame += (uint32_t)used;
    if (used)
        memmove(h->frames, h->frames + used, h->frame_count * sizeof *h->frames);
    h->callbacks.segment(h->ctx, segment);
}

static void end(struct live_voice *h) {
    struct error e;
    h->finished = true;
    if (!h->handed) {
        error_set(&e, ERROR_BAD_SOUND, "no sound has arrived");
        h->callbacks.problem(h->ctx, &e, false);
    }
    h->callbacks.finished(h->ctx, h->handed);
}

/* Recognises what is needed and delivers complete segments. */
static void live_deliver(struct live_voice *h) {
    size_t size = 1;
    if (h->finished || !h->started)
        return;
    while (size && h->handed - h->released < LIVE_PIECES) {
        recognise_ahead(h);
        size = piece_size(h);
        if (size)
            pass_on(h, size);
    }
    if (h->recognised_all && !h->pcm_count)
        end(h);
}

enum { OPUS_CHANNELS_MOST = 2, FRAME_BYTES_MOST = 16 };

const char *const live_codecs[] = {[LIVE_PCM] = "pcm_s16le", [LIVE_OPUS] = "opus", NULL};

struct live_audio {
    unsigned rate, channels;
    struct mixdown mixdown;
    OpusDecoder *opus; /* NULL = PCM */
    uint8_t part[FRAME_BYTES_MOST];
    size_t part_size; /* bytes of an incomplete sample of all channels */
    size_t bytes;     /* received */
};

int live_codec_find(const char *name, enum live_codec *codec, struct error *e) {
    if (!strcmp(name, "pcm"))
        return *codec = LIVE_PCM, 0;
    for (int i = 0; live_codecs[i]; i++)
        if (!strcmp(name, live_codecs[i]))
            return *codec = (enum live_codec)i, 0;
    return error_in_field(e, ERROR_UNKNOWN_CODEC, "codec",
                          "unknown codec '%.32s'; the codecs are pcm_s16le and opus", name);
}

static bool opus_rate(unsigned rate) {
    return rate == 8000 || rate == 12000 || rate == 16000 || rate == 24000 || rate == 48000;
}

int live_request_check(const struct live_request *r, struct error *e) {
    if (r->rate < LIVE_RATE_MIN || r->rate > LIVE_RATE_MAX)
        return error_in_field(e, ERROR_BAD_FIELD, "rate", "must be a number of samples per second, %d to %d",
                              LIVE_RATE_MIN, LIVE_RATE_MAX);
    if (r->channels < 1 || r->channels > LIVE_CHANNELS_MAX)
        return error_in_field(e, ERROR_BAD_FIELD, "channels", "must be 1 to %d", LIVE_CHANNELS_MAX);
    if (r->codec == LIVE_OPUS && !opus_rate(r->rate))
        return error_in_field(e, ERROR_BAD_FIELD, "rate",
                              "of Opus must be 8000, 12000, 16000, 24000 or 48000");
    if (r->codec == LIVE_OPUS && r->channels > OPUS_CHANNELS_MOST)
        return error_in_field(e, ERROR_BAD_FIELD, "channels", "of Opus must be 1 or 2");
    return 0;
}

struct live_audio *live_audio_new(const struct live_request *r, struct error *e) {
    if (live_request_check(r, e))
        return NULL;
    struct live_audio *s = mem_alloc(sizeof *s);
    *s = (struct live_audio){.rate = r->rate, .channels = r->channels};
    int status = OPUS_OK;
    if (r->codec == LIVE_OPUS)
        s->opus = opus_decoder_create((opus_int32)r->rate, (int)r->channels, &status);
    if (status == OPUS_OK)
        return s;
    error_set(e, ERROR_BAD_SOUND, "Opus: %s", opus_strerror(status));
    free(s);
    return NULL;
}

void live_audio_free(struct live_audio *s) {
    if (s && s->opus)
        opus_decoder_destroy(s->opus);
    free(s);
}

struct taker {
    void (*give)(void *ctx, const int16_t *samples, size_t count);
    void *ctx;
};

static void mix(struct live_audio *s, const int16_t *samples, size_t frames, const struct taker *to) {
    int16_t mono[LIVE_BLOCK];
    float frame[LIVE_CHANNELS_MAX];
    while (frames) {
        size_t count = frames < LIVE_BLOCK ? frames : LIVE_BLOCK;
        for (size_t i = 0; i < count; i++, samples += s->channels) {
            for (unsigned c = 0; c < s->channels; c++)
                frame[c] = (float)samples[c] / 32768;
            mono[i] = (int16_t)fmin(32767, lrint(32768 * mixdown_frame(&s->mixdown, frame, s->channels)));
        }
        to->give(to->ctx, mono, count);
        frames -= count;
    }
}

/* Reassembles samples from messages that may be cut anywhere. */
static void read_pcm(struct live_audio *s, const uint8_t *bytes, size_t size, const struct taker *to) {
    int16_t block[1024];
    const size_t frame = s->channels * sizeof *block;
    const size_t most = sizeof block / frame;
    size_t frames = 0;
    for (size_t i = 0; i < size; i++) {
        s->part[s->part_size++] = bytes[i];
        if (s->part_size < frame)
            continue;
        for (size_t c = 0; c < s->channels; c++)
            block[frames * s->channels + c] =
                (int16_t)(uint16_t)(s->part[2 * c] | (unsigned)s->part[2 * c + 1] << 8);
        s->part_size = 0;
        if (++frames == most) {
            mix(s, block, frames, to);
            frames = 0;
        }
    }
    mix(s, block, frames, to);
}

static int bad_packet(struct error *e, uint64_t at, int status) {
    return error_at_byte(e, ERROR_BAD_SOUND, (size_t)at, "invalid Opus packet: %s", opus_strerror(status));
}

static int read_opus(struct live_audio *s, const uint8_t *bytes, size_t size, const struct taker *to,
                     struct error *e) {
    const size_t most = (size_t)s->rate / OPUS_PACKETS_A_SECOND * OPUS_PACKET_LONGEST;
    opus_int16 *samples = mem_alloc(most * s->channels * sizeof *samples);
    int concealed, frames = opus_packet_decode(s->opus, s->rate, bytes, size, samples, &concealed);
    int failed = frames < 0 ? bad_packet(e, s->bytes, frames) : 0;
    if (frames < 0)
        frames = concealed;
    if (frames > 0)
        mix(s, samples, (size_t)frames, to);
    free(samples);
    return failed;
}

int live_audio_read(struct live_audio *s, const uint8_t *bytes, size_t size,
                    void (*give)(void *ctx, const int16_t *samples, size_t count), void *ctx,
                    struct error *e) {
    const struct taker to = {give, ctx};
    int failed = 0;
    if (s->opus)
        failed = read_opus(s, bytes, size, &to, e);
    else
        read_pcm(s, bytes, size, &to);
    s->bytes += size;
    return failed;
}

int live_audio_end(const struct live_audio *s, struct error *e) {
    return s->part_size ? error_at_byte(e, ERROR_BAD_SOUND, s->bytes, "the last sample is incomplete") : 0;
}

static void problem(struct live_voice *h, const struct error *e, bool warning) {
    h->callbacks.problem(h->ctx, e, warning);
}

static int choose(struct live_voice *h, struct error *e) {
    const struct pipeline *pipeline = h->pipeline;
    const char *lang = h->request.lang ? h->request.lang : pipeline->default_lang;
    h->pack = speech_packs_find(pipeline->packs, lang);
    if (!h->pack)
        return error_in_field(e, ERROR_UNKNOWN_LANGUAGE, "lang", "unknown language '%s'", lang);
    if (!lip_face_speaks(h->request.engine, h->pack))
        return error_in_field(e, ERROR_UNKNOWN_ENGINE, "engine", "unknown engine '%s' for '%s'",
                              h->request.engine, lang);
    return 0;
}

static unsigned voices_of(const struct live_pool *pool, uint32_t quota_key) {
    const struct live_voice *other;
    unsigned count = 0;
    DL_FOREACH(pool->voices, other)
    count += quota_key && other->request.quota_key == quota_key;
    return count;
}

static void on_samples(void *ctx, const int16_t *samples, size_t count);
static void close_voice(struct live_voice *h);

/* The clock cannot count further. */
static bool awaits(const struct live_voice *h) {
    return (!h->closed || decodes(h)) && h->given < UINT32_MAX / 2;
}

static void go_on(struct live_voice *h) {
    if (!h->closed && !awaits(h))
        close_voice(h);
    else if (h->closed && h->started)
        live_deliver(h);
}

static void on_packet(void *ctx, const int16_t *samples, size_t frames, int status, uint64_t at) {
    struct live_voice *h = ctx;
    const struct taker to = {on_samples, h};
    struct error e;
    mix(h->sound, samples, frames, &to);
    if (status && !h->told_bad) {
        h->told_bad = true;
        bad_packet(&e, at, status);
        problem(h, &e, true);
    }
    go_on(h);
}

static void on_decoder_failed(void *ctx, const char *why) {
    struct live_voice *h = ctx;
    struct error e;
    error_set(&e, ERROR_BAD_SOUND, "the Opus decoder %s", why);
    problem(h, &e, true);
    if (h->closed)
        go_on(h);
    else
        close_voice(h);
}

/* Decodes packets, which are untrusted, in a separate process if a program for it is configured. */
static int open_sound(struct live_voice *h, const struct live_request *request, struct error *e) {
    static const struct opus_process_calls calls = {on_packet, on_decoder_failed};
    const struct reader *reader = h->pipeline->reader;
    struct live_request samples = *request;
    if (request->codec == LIVE_OPUS && reader && reader->program && *reader->program) {
        h->opus = opus_process_new(h->pipeline->loop, reader, request->rate, request->channels, &calls, h, e);
        if (!h->opus)
            return -1;
        samples.codec = LIVE_PCM;
    }
    h->sound = live_audio_new(&samples, e);
    return h->sound ? 0 : -1;
}

/* The spelling engine cannot work without text, so its fallback is used. */
static int open_all(struct live_voice *h, const struct live_request *request, struct error *e) {
    const struct live_pool *pool = h->pipeline->live;
    if (!pool || !pool->network)
        return error_set(e, ERROR_VOICE_UNAVAILABLE, "this daemon has no models/hear/network.bin");
    if (live_request_check(request, e) || choose(h, e))
        return -1;
    if (pool->count >= pool->most)
        return error_set(e, ERROR_TOO_MANY_VOICES, "%u live voices are open already", pool->count);
    if (pool->key_most && voices_of(pool, h->request.quota_key) >= pool->key_most)
        return error_set(e, ERROR_TOO_MANY_VOICES,
                         "%u live voices of one address or subject are open already", pool->key_most);
    const struct lip_recogniser_options options = {.network = pool->network,
                                                   .pack = h->pack,
                                                   .engine = h->request.engine,
                                                   .rate = request->rate,
                                                   .channels = 1,
                                                   .lookahead = request->lookahead,
                                                   .fps = h->request.fps,
                                                   .lives = !h->request.still && h->request.life != 0,
                                                   .frame = live_frame,
                                                   .ctx = h};
    h->recogniser = lip_recogniser_new(&options, e);
    if (!h->recogniser || open_sound(h, request, e))
        return -1;
    jitter_buffer_open(&h->jitter, h->rate, (size_t)h->rate * pool->seconds);
    return 0;
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

static void stop_timer(struct live_voice *h) {
    if (h->timer)
        uv_close((uv_handle_t *)h->timer, free_timer);
    h->timer = NULL;
}

static void free_all(struct live_voice *h) {
    lip_recogniser_free(h->recogniser);
    live_audio_free(h->sound);
    opus_process_free(h->opus);
    jitter_buffer_free(&h->jitter);
    request_free(&h->request);
    free(h->pcm);
    free(h->frames);
    free(h);
}

static uint64_t most_silence(const struct live_voice *h) {
    return (uint64_t)h->pipeline->open_seconds * 1000;
}

/* Closes a voice that stays silent, so that waiting utterances get their turn. */
static void on_timer(uv_timer_t *timer) {
    struct live_voice *h = timer->data;
    uint64_t silent = uv_now(h->pipeline->loop) - h->last;
    struct error e;
    if (silent < most_silence(h)) {
        uv_timer_start(timer, on_timer, most_silence(h) - silent, 0);
        return;
    }
    error_set(&e, ERROR_UNFINISHED,
              h->fresh ? "too little sound arrived in %u s" : "no sound arrived for %u s",
              h->pipeline->open_seconds);
    problem(h, &e, true);
    close_voice(h);
}

static void tell_skip(struct live_voice *h) {
    struct error e;
    if (h->told_skip)
        return;
    h->told_skip = true;
    error_set(&e, ERROR_SKIPPED, "sound arrives faster than real time: more than %u s was waiting",
              h->pipeline->live->seconds);
    problem(h, &e, true);
}

/* Drops samples that do not fit. Reports it once, and not for an utterance that still waits in the queue. */
static void on_samples(void *ctx, const int16_t *samples, size_t count) {
    struct live_voice *h = ctx;
    h->fresh += count;
    if (h->fresh * 100 >= (uint64_t)h->rate * h->pipeline->open_seconds * LIVE_MIN_PERCENT) {
        h->last = uv_now(h->pipeline->loop);
        h->fresh = 0;
    }
    size_t out = jitter_buffer_add(&h->jitter, samples, count, (double)uv_hrtime() / 1e9);
    if (h->started)
        live_deliver(h);
    if (out && h->started)
        tell_skip(h);
}

static void close_voice(struct live_voice *h) {
    struct error e;
    if (h->closed)
        return;
    h->closed = true;
    stop_timer(h);
    if (live_audio_end(h->sound, &e))
        problem(h, &e, true);
    if (h->started)
        live_deliver(h);
}

/* The voice as a source. */

static struct live_voice *of(struct speech_source *source) {
    return (struct live_voice *)source;
}

static const struct live_voice *of_const(const struct speech_source *source) {
    return (const struct live_voice *)source;
}

static void source_catch_up(struct speech_source *source) {
    struct live_voice *h = of(source);
    jitter_buffer_catch_up(&h->jitter);
    jitter_buffer_begin(&h->jitter);
}

/* Drops what was said before. */
static void source_start(struct speech_source *source) {
    of(source)->started = true;
    source_catch_up(source);
    live_deliver(of(source));
}

static void source_release(struct speech_source *source) {
    of(source)->released++;
    live_deliver(of(source));
}

static void source_free(struct speech_source *source) {
    struct live_voice *h = of(source);
    stop_timer(h);
    h->pipeline->live->count--;
    DL_DELETE(h->pipeline->live->voices, h);
    free_all(h);
}

static double source_fps(const struct speech_source *source) {
    return source->request->fps;
}

static const char *source_id(const struct speech_source *source) {
    return source->request->id;
}

static void source_describe(const struct speech_source *source, struct source_description *description) {
    const struct live_voice *h = of_const(source);
    const char *lang = h->request.lang, *engine = h->request.engine;
    *description = (struct source_description){
        .live = true,
        .lookahead = h->lookahead,
        .lang = lang && speech_pack_is_general(h->pack) ? lang : speech_pack_lang(h->pack),
        .engine = engine ? engine : LIP_ENGINE};
}

static bool source_is_open(const struct speech_source *source) {
    return !of_const(source)->closed;
}

static void source_close(struct speech_source *source) {
    close_voice(of(source));
}

static bool source_awaits(const struct speech_source *source) {
    return awaits(of_const(source));
}

/* In the silence the lips return to rest. */
static void source_wait(struct speech_source *source, unsigned ms) {
    static const int16_t silence[LIVE_RATE_MAX / BLOCKS_A_SECOND];
    struct live_voice *h = of(source);
    h->stalled = true;
    for (unsigned i = 0; !h->recognised_all && i < ms * BLOCKS_A_SECOND / 1000; i++)
        live_recognise(h, silence, h->rate / BLOCKS_A_SECOND);
    live_deliver(h);
}

static unsigned source_grace(const struct speech_source *source) {
    return of_const(source)->stalled ? 0 : LIVE_STALL_MS;
}

static void source_write_sound(struct speech_source *source, const uint8_t *bytes, size_t size) {
    struct live_voice *h = of(source);
    struct error e;
    if (h->closed)
        return;
    if (h->stalled)
        jitter_buffer_begin(&h->jitter);
    h->stalled = false;
    if (h->opus) {
        if (!opus_process_write(h->opus, bytes, size))
            tell_skip(h);
        return;
    }
    if (live_audio_read(h->sound, bytes, size, on_samples, h, &e) && !h->told_bad) {
        h->told_bad = true;
        problem(h, &e, true);
    }
    if (!awaits(h))
        close_voice(h);
}

struct speech_source *live_voice_open(const struct pipeline *pipeline, void *request,
                                      const struct synthesis_callbacks *callbacks, void *ctx,
                                      struct error *e) {
    static const struct speech_source_ops ops = {.start = source_start,
                                                 .release = source_release,
                                                 .free = source_free,
                                                 .fps = source_fps,
                                                 .id = source_id,
                                                 .describe = source_describe,
                                                 .is_open = source_is_open,
                                                 .close = source_close,
                                                 .awaits = source_awaits,
                                                 .wait = source_wait,
                                                 .grace = source_grace,
                                                 .write_sound = source_write_sound,
                                                 .catch_up = source_catch_up};
    const struct live_request *format = request;
    struct live_voice *h = mem_alloc(sizeof *h);
    *h = (struct live_voice){.base = {.ops = &ops, .request = &h->request, .one_face = true},
                             .pipeline = pipeline,
                             .callbacks = *callbacks,
                             .ctx = ctx,
                             .rate = format->rate,
                             .lookahead = format->lookahead,
                             .last = uv_now(pipeline->loop)};
    request_copy(&h->request, format->speech);
    if (open_all(h, format, e)) {
        free_all(h);
        return NULL;
    }
    pipeline->live->count++;
    DL_APPEND(pipeline->live->voices, h);
    h->timer = mem_alloc(sizeof *h->timer);
    uv_timer_init(pipeline->loop, h->timer);
    h->timer->data = h;
    if (most_silence(h))
        uv_timer_start(h->timer, on_timer, most_silence(h), 0);
    return &h->base;
}
