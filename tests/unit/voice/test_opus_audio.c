/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/coder_pool.h"
#include "server/codec/opus_audio.h"
#include <math.h>
#include <opus/opus.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A sweep of one second with varying loudness, which makes time shifts visible. */
static int16_t *sweep(uint32_t rate) {
    int16_t *pcm = malloc(rate * sizeof *pcm);
    for (uint32_t i = 0; i < rate; i++) {
        double t = (double)i / rate;
        pcm[i] = (int16_t)(12000 * sin(3.14159 * t) * sin(6.28318 * (200 * t + 400 * t * t)));
    }
    return pcm;
}

/* Decodes length-prefixed packets, checks their number and returns the number of samples. */
static size_t decode(const struct buf *packets, unsigned expected, int16_t *out, size_t cap) {
    int error;
    OpusDecoder *decoder = opus_decoder_create(OPUS_RATE, 1, &error);
    const uint8_t *at = packets->data, *end = at + packets->size;
    size_t samples = 0;
    unsigned count = 0;
    while (at < end) {
        int size = *at++;
        if (size >= 252)
            size += 4 * *at++;
        assert_true(at + size <= end && samples + OPUS_PACKET_SAMPLES <= cap);
        assert_int_equal(opus_decode(decoder, at, size, out + samples, OPUS_PACKET_SAMPLES, 0),
                         OPUS_PACKET_SAMPLES);
        samples += OPUS_PACKET_SAMPLES;
        at += size;
        count++;
    }
    opus_decoder_destroy(decoder);
    assert_int_equal(count, expected);
    return samples;
}

/* Best shift of a against b within +-limit samples. */
static int best_shift(const int16_t *a, const int16_t *b, int count, int limit) {
    double best = -1e300;
    int found = 0;
    for (int shift = -limit; shift <= limit; shift++) {
        double sum = 0;
        for (int i = limit; i < count - limit; i++)
            sum += (double)a[i] * b[i + shift];
        if (sum > best) {
            best = sum;
            found = shift;
        }
    }
    return found;
}

static void in_time(void **state) {
    (void)state;
    static const uint32_t rates[] = {8000, 16000, 22050, 24000, 44100, 48000};
    int16_t *wanted = sweep(OPUS_RATE), *heard = malloc(3 * OPUS_RATE * sizeof *heard);
    for (size_t r = 0; r < sizeof rates / sizeof *rates; r++) {
        int16_t *pcm = sweep(rates[r]);
        struct opus_audio *o = opus_audio_new(rates[r], OPUS_BITRATE);
        struct buf packets = {0};
        unsigned count = 0, piece = rates[r] / 10;
        for (uint32_t i = 0; i < rates[r]; i += piece)
            count += opus_audio_add(o, pcm + i, piece, &packets);
        count += opus_audio_end(o, &packets);
        size_t samples = decode(&packets, count, heard, 3 * OPUS_RATE), skip = opus_audio_skip(o);
        assert_int_equal(skip, OPUS_SKIP);
        assert_true(samples - skip >= OPUS_RATE - 2);
        assert_true(samples - skip < OPUS_RATE + 2 * OPUS_PACKET_SAMPLES);
        int shift = best_shift(wanted, heard + skip, OPUS_RATE - 2, 480);
        assert_in_range(shift + 480, 480 - 24, 480 + 24); /* half a millisecond */
        /* about the requested rate: 16 to 24 kbit/s, slightly more for the loud sweep */
        assert_in_range(packets.size * 8, 8000, 32000);
        buf_free(&packets);
        opus_audio_free(o);
        free(pcm);
    }
    free(wanted);
    free(heard);
}

/* Tells whether the packet after the length is CELT (RFC 6716, 3.1). */
static bool is_transform(const uint8_t *at) {
    return at[at[0] < 252 ? 1 : 2] >> 3 >= 16;
}

/* Changing levels up and down shifts nothing, and packets use the intended mode. */
static void levels(void **state) {
    (void)state;
    enum { RATE = 22050, PIECE = RATE / 20 };
    int16_t *wanted = sweep(OPUS_RATE), *heard = malloc(3 * OPUS_RATE * sizeof *heard), *pcm = sweep(RATE);
    struct opus_audio *o = opus_audio_new(RATE, OPUS_BITRATE);
    struct buf packets = {0};
    unsigned count = 0, kinds[2] = {0};
    for (uint32_t i = 0; i + PIECE <= RATE; i += PIECE) {
        unsigned step = i / PIECE / 2,
                 level = step < CODEC_LOAD_LEVELS ? step : 2 * CODEC_LOAD_LEVELS - 1 - step;
        opus_audio_set_level(o, level);
        size_t before = packets.size;
        unsigned added = opus_audio_add(o, pcm + i, PIECE, &packets);
        count += added;
        /* the first packets after a change may still be of the kind before */
        if (added && (level == CODEC_LOAD_BEST || level == CODEC_LOAD_LEVELS - 1))
            kinds[level != CODEC_LOAD_BEST] +=
                is_transform(packets.data + before) == (level != CODEC_LOAD_BEST);
    }
    count += opus_audio_end(o, &packets);
    assert_int_equal(opus_audio_skip(o), OPUS_SKIP);
    decode(&packets, count, heard, 3 * OPUS_RATE);
    int shift = best_shift(wanted, heard + OPUS_SKIP, OPUS_RATE - 2, 480);
    assert_in_range(shift + 480, 480 - 24, 480 + 24);
    assert_in_range(packets.size * 8, 8000, 36000);
    assert_true(kinds[0] >= 2);
    assert_true(kinds[1] >= 2);
    buf_free(&packets);
    opus_audio_free(o);
    free(pcm);
    free(wanted);
    free(heard);
}

/* A requested bit rate holds at every level; the default depends on the sample rate, and few bits are not
 * wasted on high frequencies. */
static void bits(void **state) {
    (void)state;
    enum { RATE = 22050 };
    static const unsigned wishes[] = {8000, 12000, 0, 32000};
    int16_t *pcm = sweep(RATE);
    size_t before = 0;
    for (size_t w = 0; w < sizeof wishes / sizeof *wishes; w++) {
        struct opus_audio *o = opus_audio_new(RATE, wishes[w]);
        struct buf packets = {0};
        if (wishes[w] && wishes[w] < OPUS_BITRATE_VOICE)
            opus_audio_set_level(o, CODEC_LOAD_LEVELS - 1);
        opus_audio_add(o, pcm, RATE, &packets);
        assert_true(packets.size > before + before / 8);
        assert_false(is_transform(packets.data));
        before = packets.size;
        buf_free(&packets);
        opus_audio_free(o);
    }
    free(pcm);
}

/* The result does not depend on how the sound is split. */
static void pieces(void **state) {
    (void)state;
    int16_t *pcm = sweep(22050);
    struct buf whole = {0}, cut = {0};
    struct opus_audio *a = opus_audio_new(22050, OPUS_BITRATE), *b = opus_audio_new(22050, OPUS_BITRATE);
    opus_audio_add(a, pcm, 22050, &whole);
    opus_audio_end(a, &whole);
    for (size_t i = 0, n; i < 22050; i += n) {
        n = 1 + i * 7919 % 700;
        n = n < 22050 - i ? n : 22050 - i;
        opus_audio_add(b, pcm + i, n, &cut);
    }
    opus_audio_end(b, &cut);
    assert_int_equal(whole.size, cut.size);
    assert_memory_equal(whole.data, cut.data, whole.size);
    opus_audio_free(a);
    opus_audio_free(b);
    buf_free(&whole);
    buf_free(&cut);
    free(pcm);
}

static void nothing(void **state) {
    (void)state;
    struct opus_audio *o = opus_audio_new(22050, OPUS_BITRATE);
    struct buf out = {0};
    assert_int_equal(opus_audio_add(o, NULL, 0, &out), 0);
    unsigned count = opus_audio_end(o, &out);
    assert_in_range(count, 0, 1); /* what the decoder skips */
    opus_audio_free(o);
    buf_free(&out);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_time), cmocka_unit_test(levels),  cmocka_unit_test(bits),
        cmocka_unit_test(pieces),  cmocka_unit_test(nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
