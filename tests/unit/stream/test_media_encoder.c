/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coding on threads gives the same bytes in the same order as without, under any load. */
#include "protocol/chunk/compact.h"
#include "server/codec/coder_pool.h"
#include "server/codec/media_encoder.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RATE = 22050, SAMPLES = 4410, FRAMES = 5, CHUNKS = 40, STREAMS = 12 };

struct heard {
    struct buf bytes;
    size_t answers, messages, begins;
    uintptr_t last; /* tag */
};

static void on_done(void *ctx, void *tag, const struct encoded *encoded) {
    struct heard *h = ctx;
    assert_int_equal((uintptr_t)tag, h->last + 1);
    h->last = (uintptr_t)tag;
    h->answers++;
    h->messages += encoded->size > 0;
    h->begins += encoded->begin;
    buf_add(&h->bytes, encoded->data, encoded->size);
}

static const struct encoding opus = {CHUNK_AUDIO_OPUS, CHUNK_FAP_FAPC, 0, true};

/* Encodes a chunk whose sound buffer is reused afterwards. */
static void say(struct encoder *e, uint32_t utterance, uint32_t k, uintptr_t tag) {
    static int16_t pcm[SAMPLES];
    static struct fap_frame frames[FRAMES];
    for (uint32_t i = 0; i < SAMPLES; i++)
        pcm[i] = (int16_t)(8000 * sin(0.0001 * utterance * (k * SAMPLES + i) * (1 + k % 3)));
    for (uint32_t i = 0; i < FRAMES; i++) {
        frames[i].mask[0] = 0xFC;
        frames[i].value[2] = (int16_t)(k * 7 + i * utterance);
    }
    struct stream_event word = {
        .kind = STREAM_WORD, .sample = k * SAMPLES, .duration = 100, .end = 3, .text = "uno"};
    encoder_event(e, &word);
    const struct media media = {.utterance = utterance,
                                .sample_rate = RATE,
                                .fps = 25,
                                .start = k * SAMPLES,
                                .samples = SAMPLES,
                                .pcm = pcm,
                                .first_frame = k * FRAMES,
                                .frame_count = FRAMES,
                                .frames = frames};
    encoder_media(e, &media, (void *)tag);
    memset(pcm, 0x55, sizeof pcm);
    memset(frames, 0, sizeof frames);
}

/* Two utterances of a stream. */
static void say_all(struct encoder *e, uint32_t first, struct heard *h) {
    uintptr_t tag = h->last;
    for (uint32_t utterance = first; utterance < first + 2; utterance++) {
        for (uint32_t k = 0; k < CHUNKS; k++)
            say(e, utterance, k, ++tag);
        encoder_end(e, true, (void *)++tag);
    }
}

static void test_same(void **state) {
    uv_loop_t loop;
    struct encoder *encoders[STREAMS];
    struct heard heard[STREAMS] = {0};
    (void)state;
    uv_loop_init(&loop);
    struct coder_pool *pool = coder_pool_open(&loop, 3);
    assert_int_equal(coder_pool_threads(pool), 3);
    for (uint32_t i = 0; i < STREAMS; i++) {
        encoders[i] = encoder_new(&opus, pool, NULL, on_done, &heard[i]);
        say_all(encoders[i], 3 * i + 1, &heard[i]);
        assert_int_equal(heard[i].answers, 0); /* nothing was coded on the loop */
    }
    for (uint32_t i = 0; i < STREAMS; i++)
        while (heard[i].answers < 2 * (CHUNKS + 1))
            uv_run(&loop, UV_RUN_ONCE);
    assert_true(coder_pool_worked(pool) > 0);
    for (uint32_t i = 0; i < STREAMS; i++) {
        struct heard alone = {0};
        struct encoder *e = encoder_new(&opus, NULL, NULL, on_done, &alone);
        say_all(e, 3 * i + 1, &alone);
        assert_int_equal(alone.answers, 2 * (CHUNKS + 1));
        assert_int_equal(alone.bytes.size, heard[i].bytes.size);
        assert_memory_equal(alone.bytes.data, heard[i].bytes.data, alone.bytes.size);
        assert_int_equal(alone.begins, heard[i].begins);
        buf_free(&alone.bytes);
        buf_free(&heard[i].bytes);
        encoder_free(e);
        encoder_free(encoders[i]);
    }
    coder_pool_close(pool);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
}

/* Stopped chunks are not coded; the next utterance is a starting point. */
static void test_stop(void **state) {
    uv_loop_t loop;
    struct heard h = {0};
    (void)state;
    uv_loop_init(&loop);
    struct coder_pool *pool = coder_pool_open(&loop, 1);
    struct encoder *e = encoder_new(&opus, pool, NULL, on_done, &h);
    for (uint32_t k = 0; k < 400; k++)
        say(e, 1, k, k + 1);
    encoder_end(e, false, (void *)401);
    while (h.answers < 401)
        uv_run(&loop, UV_RUN_ONCE);
    assert_in_range(h.messages, 0, 399);
    size_t before = h.begins;
    say(e, 2, 0, 402);
    encoder_end(e, true, (void *)403);
    while (h.answers < 403)
        uv_run(&loop, UV_RUN_ONCE);
    /* decoders could start at least once */
    assert_true(before + h.begins > 0);
    encoder_free(e);
    coder_pool_close(pool);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    buf_free(&h.bytes);
}

/* Encoder and pool may be freed while chunks are being coded; no callback follows. */
static void test_leave(void **state) {
    uv_loop_t loop;
    (void)state;
    for (int round = 0; round < 20; round++) {
        struct heard heard[STREAMS] = {0};
        struct encoder *encoders[STREAMS];
        size_t answers = 0;
        uv_loop_init(&loop);
        struct coder_pool *pool = coder_pool_open(&loop, 2);
        for (int i = 0; i < STREAMS; i++) {
            encoders[i] = encoder_new(&opus, pool, NULL, on_done, &heard[i]);
            for (uint32_t k = 0; k < 4; k++)
                say(encoders[i], 1, k, k + 1);
        }
        for (int i = 0; i < round % 4; i++)
            uv_run(&loop, UV_RUN_ONCE);
        for (int i = 0; i < STREAMS; i++) {
            answers += heard[i].answers;
            encoder_free(encoders[i]);
        }
        if (round % 2)
            uv_run(&loop, UV_RUN_NOWAIT);
        coder_pool_close(pool);
        uv_run(&loop, UV_RUN_DEFAULT);
        assert_int_equal(uv_loop_close(&loop), 0);
        for (int i = 0; i < STREAMS; i++) {
            answers -= heard[i].answers;
            buf_free(&heard[i].bytes);
        }
        assert_int_equal(answers, 0);
    }
}

/* PCM is only copied, so it needs no thread. */
static void test_at_once(void **state) {
    static const struct encoding pcm = {CHUNK_AUDIO_PCM_S16LE, CHUNK_FAP_PLAIN, 0, false};
    uv_loop_t loop;
    struct heard h = {0};
    (void)state;
    uv_loop_init(&loop);
    struct coder_pool *pool = coder_pool_open(&loop, 1);
    struct encoder *e = encoder_new(&pcm, pool, NULL, on_done, &h);
    say(e, 1, 0, 1);
    assert_int_equal(h.messages, 1);
    assert_true(h.bytes.size > SAMPLES * 2);
    encoder_end(e, true, (void *)2);
    assert_int_equal(h.answers, 2);
    encoder_free(e);
    coder_pool_close(pool);
    uv_run(&loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&loop), 0);
    buf_free(&h.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same), cmocka_unit_test(test_stop),
                                       cmocka_unit_test(test_leave), cmocka_unit_test(test_at_once)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
