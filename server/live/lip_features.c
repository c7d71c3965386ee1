/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/lip_features.h"
#include "server/base/mem.h"
#include "server/base/sound/mixdown.h"
#include <gsl/gsl_fft_real.h>
#include <math.h>
#include <soxr.h>
#include <stdlib.h>
#include <string.h>

#define LOWEST_HZ 100.0
#define HIGHEST_HZ 7000.0
#define TAU 6.283185307179586

/* Loudness is the natural logarithm of power. The recent maximum decays by 3 dB a second; anything below
 * -50 dB of full scale is silence. */
#define FORGET 0.007
#define SOFTEST -11.5
#define FIRST_LOUDNESS -7.0
/* Bands are clipped 43 dB below that. */
#define DEPTH 10.0
/* The spectral mean per band covers frames at most 22 dB below the maximum, over 3 s; it starts as the
 * mean of the training voices with the weight of one second. */
#define LOUD 5.0
#define COLOUR_FRAMES 300.0
#define COLOUR_FIRST 100.0
#define SCALE 0.4

static const double first_colour[LIP_BANDS] = {
    -1.8, -1.0, -0.8, -0.7, -0.8, -1.2, -1.9, -2.7, -3.3, -3.7, -4.2, -4.5, -4.7, -4.8, -5.0, -5.3,
    -5.5, -5.5, -5.2, -4.7, -4.5, -4.6, -4.8, -5.0, -5.5, -6.6, -7.4, -8.1, -8.4, -8.5, -8.5, -8.4,
};

struct band {
    size_t from, to; /* bins */
    double weight[LIP_FFT / 2 + 1];
};

struct lip_features {
    void (*take)(void *ctx, const float frame[LIP_FEATURES]);
    void *ctx;
    double window[LIP_WINDOW];
    struct band bands[LIP_BANDS];
    float samples[LIP_WINDOW];
    size_t filled;
    double loudest, colour[LIP_BANDS], colour_frames;
};

static double mel(double hz) {
    return 2595 * log10(1 + hz / 700);
}

/* Triangular bands that reach to their neighbours' centres, normalised for white noise. */
static void make_bands(struct lip_features *f) {
    double low = mel(LOWEST_HZ), step = (mel(HIGHEST_HZ) - low) / (LIP_BANDS + 1), squares = 0;
    for (int i = 0; i < LIP_WINDOW; i++) {
        f->window[i] = 0.5 - 0.5 * cos(TAU * (i + 0.5) / LIP_WINDOW);
        squares += f->window[i] * f->window[i];
    }
    for (int b = 0; b < LIP_BANDS; b++) {
        struct band *band = &f->bands[b];
        double sum = 0;
        for (size_t k = 1; k < LIP_FFT / 2; k++) {
            double x = (mel((double)k * LIP_RATE / LIP_FFT) - low) / step - b;
            band->weight[k] = fmax(0, 1 - fabs(x - 1));
            sum += band->weight[k];
            if (band->weight[k] > 0) {
                band->from = band->from ? band->from : k;
                band->to = k + 1;
            }
        }
        for (size_t k = band->from; k < band->to; k++)
            band->weight[k] /= sum * squares;
    }
}

struct lip_features *lip_features_new(void (*take)(void *ctx, const float frame[LIP_FEATURES]), void *ctx) {
    struct lip_features *f = mem_alloc(sizeof *f);
    f->take = take;
    f->ctx = ctx;
    f->loudest = FIRST_LOUDNESS;
    f->colour_frames = COLOUR_FIRST;
    memcpy(f->colour, first_colour, sizeof first_colour);
    make_bands(f);
    return f;
}

void lip_features_free(struct lip_features *f) {
    free(f);
}

static void analyse(struct lip_features *f) {
    double x[LIP_FFT] = {0}, energy = 0, value[LIP_BANDS];
    float frame[LIP_FEATURES];
    for (int i = 0; i < LIP_WINDOW; i++) {
        energy += (double)f->samples[i] * f->samples[i];
        x[i] = f->samples[i] * f->window[i];
    }
    double loudness = log(energy / LIP_WINDOW + 1e-10);
    f->loudest = fmax(SOFTEST, fmax(loudness, f->loudest - FORGET));
    gsl_fft_real_radix2_transform(x, 1, LIP_FFT);
    for (int b = 0; b < LIP_BANDS; b++) {
        const struct band *band = &f->bands[b];
        double power = 1e-10;
        for (size_t k = band->from; k < band->to; k++)
            power += band->weight[k] * (x[k] * x[k] + x[LIP_FFT - k] * x[LIP_FFT - k]);
        value[b] = fmax(-DEPTH, log(power) - f->loudest);
    }
    if (loudness > f->loudest - LOUD && loudness > SOFTEST) {
        f->colour_frames = fmin(f->colour_frames + 1, COLOUR_FRAMES);
        for (int b = 0; b < LIP_BANDS; b++)
            f->colour[b] += (value[b] - f->colour[b]) / f->colour_frames;
    }
    for (int b = 0; b < LIP_BANDS; b++)
        frame[b] = (float)(SCALE * (value[b] - f->colour[b]));
    frame[LIP_BANDS] = (float)(SCALE * fmax(-DEPTH, loudness - f->loudest) + 1);
    f->take(f->ctx, frame);
}

void lip_features_write(struct lip_features *f, const float *samples, size_t count) {
    while (count) {
        size_t n = LIP_WINDOW - f->filled < count ? LIP_WINDOW - f->filled : count;
        memcpy(f->samples + f->filled, samples, n * sizeof *samples);
        f->filled += n;
        samples += n;
        count -= n;
        if (f->filled < LIP_WINDOW)
            return;
        analyse(f);
        f->filled = LIP_WINDOW - LIP_HOP;
        memmove(f->samples, f->samples + LIP_HOP, f->filled * sizeof *f->samples);
    }
}

/* The resampler always gets blocks of 10 ms, so that the result does not depend on how sound arrives. */
enum { BLOCK_MOST = LIP_RATE_MOST / 100, READY_MOST = LIP_RATE / 50 };

/* High-pass filter that removes the mean: -3 dB at 38 Hz. */
#define KEEP 0.985F

struct lip_input {
    unsigned channels;
    struct mixdown mixdown;
    soxr_t resampler; /* NULL if the rate is LIP_RATE */
    void (*take)(void *ctx, const float *samples, size_t count);
    void *ctx;
    float block[BLOCK_MOST];
    size_t block_size, filled;
    float before, mean_free; /* last input and output of the filter */
};

struct lip_input *lip_input_new(unsigned rate, unsigned channels,
                                void (*take)(void *ctx, const float *samples, size_t count), void *ctx,
                                struct error *e) {
    if (rate < LIP_RATE_LEAST || rate > LIP_RATE_MOST) {
        error_set(e, ERROR_BAD_SOUND, "%u samples a second; %d to %d are supported", rate, LIP_RATE_LEAST,
                  LIP_RATE_MOST);
        return NULL;
    }
    if (channels < 1 || channels > LIP_CHANNELS_MOST) {
        error_set(e, ERROR_BAD_SOUND, "%u channels; at most %d are supported", channels, LIP_CHANNELS_MOST);
        return NULL;
    }
    struct lip_input *s = mem_alloc(sizeof *s);
    *s = (struct lip_input){.channels = channels, .take = take, .ctx = ctx, .block_size = rate / 100};
    if (rate != LIP_RATE) {
        soxr_error_t error = NULL;
        soxr_io_spec_t io = soxr_io_spec(SOXR_FLOAT32_I, SOXR_FLOAT32_I);
        soxr_quality_spec_t quality = soxr_quality_spec(SOXR_LQ, 0);
        soxr_runtime_spec_t runtime = soxr_runtime_spec(1);
        runtime.log2_min_dft_size = 8; /* the default would buffer too much and add latency */
        s->resampler = soxr_create(rate, LIP_RATE, 1, &error, &io, &quality, &runtime);
        if (!s->resampler) {
            error_set(e, ERROR_BAD_SOUND, "%u samples a second: %s", rate, error ? error : "no memory");
            free(s);
            return NULL;
        }
    }
    return s;
}

void lip_input_free(struct lip_input *s) {
    if (s && s->resampler)
        soxr_delete(s->resampler);
    free(s);
}

static void give(struct lip_input *s, float *samples, size_t count) {
    for (size_t i = 0; i < count; i++) {
        float x = samples[i];
        s->mean_free = x - s->before + KEEP * s->mean_free;
        s->before = x;
        samples[i] = s->mean_free;
    }
    if (count)
        s->take(s->ctx, samples, count);
}

/* Processes a block; count 0 = the end. */
static void pass_on(struct lip_input *s, size_t count) {
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

void lip_input_write(struct lip_input *s, const float *samples, size_t frames) {
    for (size_t i = 0; i < frames; i++) {
        float frame[LIP_CHANNELS_MOST];
        for (unsigned c = 0; c < s->channels; c++) {
            float x = samples[i * s->channels + c];
            frame[c] = isfinite(x) ? fmaxf(-1, fminf(1, x)) : 0;
        }
        s->block[s->filled++] = (float)mixdown_frame(&s->mixdown, frame, s->channels);
        if (s->filled == s->block_size)
            pass_on(s, s->filled);
    }
}

void lip_input_end(struct lip_input *s) {
    if (s->filled)
        pass_on(s, s->filled);
    if (s->resampler)
        pass_on(s, 0);
}
