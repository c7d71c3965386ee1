/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sound of a live voice: byte 0 sets codec and channels, then come rate and lookahead; then messages, each
 * preceded by its size (2 bytes). PCM divided otherwise gives the same result. */
#include "server/face/packs/speech_pack.h"
#include "server/live/jitter_buffer.h"
#include "server/live/lip_recogniser.h"
#include "server/live/live_voice.h"
#include "tests/fuzz/fuzz.h"
#include <stdlib.h>
#include <string.h>

enum { SAMPLES_MOST = 16000, MESSAGES_MOST = 200 };

/* A run of the recogniser and its result, which must not depend on how the input is divided. */
struct heard {
    struct lip_recogniser *recogniser; /* NULL: the recogniser only listens */
    struct jitter_buffer pace;
    double now;
    size_t samples;
    uint32_t frames;
    uint64_t sum;
};

static const struct speech_packs *packs(void) {
    static struct speech_packs loaded;
    struct error e;
    FUZZ_CHECK(loaded.count || !speech_packs_load(&loaded, SOURCE_ROOT "/models/speech", &e));
    return &loaded;
}

static const struct lip_network *network(void) {
    static struct lip_network *loaded;
    struct error e;
    if (!loaded)
        loaded = lip_network_load(SOURCE_ROOT "/models/hear/network.bin", &e);
    FUZZ_CHECK(loaded);
    return loaded;
}

static void on_frame(void *ctx, uint32_t k, const struct fap_frame *frame) {
    struct heard *h = ctx;
    FUZZ_CHECK(k == h->frames);
    h->frames++;
    for (int n = 3; n <= FAP_COUNT; n++)
        FUZZ_CHECK(frame->value[n] == fap_clamp(n, frame->value[n]));
}

static void on_samples(void *ctx, const int16_t *samples, size_t count) {
    struct heard *h = ctx;
    int16_t taken[1000];
    float block[1000];
    FUZZ_CHECK(count <= LIVE_BLOCK);
    h->samples += count;
    for (size_t i = 0; i < count; i++)
        h->sum = h->sum * 31 + (uint16_t)samples[i];
    if (!h->recogniser || h->samples > SAMPLES_MOST)
        return;
    jitter_buffer_add(&h->pace, samples, count, h->now);
    FUZZ_CHECK(h->pace.count <= h->pace.most);
    for (size_t got; (got = jitter_buffer_take(&h->pace, taken, sizeof taken / sizeof *taken));) {
        for (size_t i = 0; i < got; i++)
            block[i] = (float)taken[i] / 32768;
        lip_recogniser_write(h->recogniser, block, got);
    }
}

/* Passes the messages to the recogniser; divides PCM differently if `whole` is false. */
static void read_all(struct fuzz_input in, struct live_audio *sound, bool whole, struct heard *h) {
    struct error e = {0};
    for (int i = 0; i < MESSAGES_MOST && fuzz_left(&in); i++) {
        size_t size = fuzz_u16(&in);
        uint8_t *bytes = fuzz_bytes(&in, &size);
        h->now += (double)(size % 251) / 1000;
        for (size_t at = 0, piece; at < size || (whole && !at); at += piece + !piece) {
            piece = whole || size - at < 2 ? size - at : (size - at) / 2;
            if (live_audio_read(sound, bytes + at, piece, on_samples, h, &e))
                FUZZ_CHECK(e.code == ERROR_BAD_SOUND);
        }
        free(bytes);
    }
    if (live_audio_end(sound, &e))
        FUZZ_CHECK(e.code == ERROR_BAD_SOUND);
}

static void hear(struct fuzz_input in, const struct live_request *request, struct heard *h) {
    struct error e = {0};
    const struct lip_recogniser_options options = {.network = network(),
                                                   .pack = speech_packs_find(packs(), "it"),
                                                   .rate = request->rate,
                                                   .channels = 1,
                                                   .lookahead = request->lookahead,
                                                   .fps = 25,
                                                   .lives = true,
                                                   .frame = on_frame,
                                                   .ctx = h};
    struct live_audio *sound = live_audio_new(request, &e);
    h->recogniser = lip_recogniser_new(&options, &e);
    FUZZ_CHECK(sound && (h->recogniser || e.code == ERROR_BAD_FIELD));
    jitter_buffer_open(&h->pace, request->rate, request->rate);
    read_all(in, sound, true, h);
    if (h->recogniser)
        lip_recogniser_end(h->recogniser);
    lip_recogniser_free(h->recogniser);
    jitter_buffer_free(&h->pace);
    live_audio_free(sound);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct fuzz_input in = fuzz_input(data, size);
    uint8_t kind = fuzz_u8(&in), ahead = fuzz_u8(&in);
    const struct live_request request = {.codec = kind & 1 ? LIVE_OPUS : LIVE_PCM,
                                         .channels = 1 + (kind >> 1) % 9,
                                         .rate = 2U * fuzz_u16(&in),
                                         .lookahead = 20U * (ahead % 8)};
    struct error e = {0};
    if (live_request_check(&request, &e)) {
        FUZZ_CHECK(e.code == ERROR_BAD_FIELD && !live_audio_new(&request, &e));
        return 0;
    }
    struct heard once = {0}, again = {0};
    hear(in, &request, &once);
    if (request.codec == LIVE_PCM) {
        struct live_audio *sound = live_audio_new(&request, &e);
        read_all(in, sound, false, &again);
        live_audio_free(sound);
        FUZZ_CHECK(again.samples == once.samples && again.sum == once.sum);
    }
    return 0;
}
