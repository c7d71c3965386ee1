/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hear_sound.h"
#include "server/base/mem.h"
#include "server/base/mixdown.h"
#include <math.h>
#include <soxr.h>
#include <stdlib.h>

/* The resampler gets blocks of 10 ms, whatever was written: so it does the same for all. */
enum { BLOCK_MOST = HEAR_RATE_MOST / 100, READY_MOST = HEAR_RATE / 50 };

/* Of the filter that takes the mean away: down by 3 dB at 38 Hz. */
#define KEEP 0.985F

struct hear_sound {
    unsigned channels;
    struct mixdown mixdown;
    soxr_t resampler; /* NULL when the rate is right already */
    void (*take)(void *ctx, const float *samples, size_t count);
    void *ctx;
    float block[BLOCK_MOST];
    size_t block_size, filled;
    float before, mean_free; /* the filter's last input and output */
};

struct hear_sound *hear_sound_new(unsigned rate, unsigned channels,
                                  void (*take)(void *ctx, const float *samples, size_t count), void *ctx,
                                  struct error *e) {
    if (rate < HEAR_RATE_LEAST || rate > HEAR_RATE_MOST) {
        error_set(e, ERROR_BAD_SOUND, "%u samples a second, from %d to %d can be heard", rate,
                  HEAR_RATE_LEAST, HEAR_RATE_MOST);
        return NULL;
    }
    if (channels < 1 || channels > HEAR_CHANNELS_MOST) {
        error_set(e, ERROR_BAD_SOUND, "%u channels, at most %d can be heard", channels, HEAR_CHANNELS_MOST);
        return NULL;
    }
    struct hear_sound *s = mem_alloc(sizeof *s);
    *s = (struct hear_sound){.channels = channels, .take = take, .ctx = ctx, .block_size = rate / 100};
    if (rate != HEAR_RATE) {
        soxr_error_t error = NULL;
        soxr_io_spec_t io = soxr_io_spec(SOXR_FLOAT32_I, SOXR_FLOAT32_I);
        soxr_quality_spec_t quality = soxr_quality_spec(SOXR_LQ, 0);
        soxr_runtime_spec_t runtime = soxr_runtime_spec(1);
        runtime.log2_min_dft_size = 8; /* it would wait for more sound than anybody may be kept waiting for */
        s->resampler = soxr_create(rate, HEAR_RATE, 1, &error, &io, &quality, &runtime);
        if (!s->resampler) {
            error_set(e, ERROR_BAD_SOUND, "%u samples a second: %s", rate, error ? error : "no memory");
            free(s);
            return NULL;
        }
    }
    return s;
}

void hear_sound_free(struct hear_sound *s) {
    if (s && s->resampler)
        soxr_delete(s->resampler);
    free(s);
}

static void give(struct hear_sound *s, float *samples, size_t count) {
    for (size_t i = 0; i < count; i++) {
        float x = samples[i];
        s->mean_free = x - s->before + KEEP * s->mean_free;
        s->before = x;
        samples[i] = s->mean_free;
    }
    if (count)
        s->take(s->ctx, samples, count);
}

/* The block, or the end (count 0). */
static void pass_on(struct hear_sound *s, size_t count) {
    float ready[READY_MOST];
    size_t used = 0, made;
    s->filled = 0;
    if (!s->resampler) {
        give(s, s->block, count);
        return;
    }
    for (size_t at = 0;;) {
        if (soxr_process(s->resampler, count ? s->block + at : NULL, count - at, &used, ready, READY_MOST,
                         &made))
            return;
        at += used;
        give(s, ready, made);
        if (made < READY_MOST && at >= count)
            return;
    }
}

void hear_sound_write(struct hear_sound *s, const float *samples, size_t frames) {
    for (size_t i = 0; i < frames; i++) {
        float frame[HEAR_CHANNELS_MOST];
        for (unsigned c = 0; c < s->channels; c++) {
            float x = samples[i * s->channels + c];
            frame[c] = isfinite(x) ? fmaxf(-1, fminf(1, x)) : 0;
        }
        s->block[s->filled++] = (float)mixdown_frame(&s->mixdown, frame, s->channels);
        if (s->filled == s->block_size)
            pass_on(s, s->filled);
    }
}

void hear_sound_end(struct hear_sound *s) {
    if (s->filled)
        pass_on(s, s->filled);
    if (s->resampler)
        pass_on(s, 0);
}
