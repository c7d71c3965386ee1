/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/mfcc.h"
#include "server/base/mem.h"
#include <gsl/gsl_fft_real.h>
#include <math.h>
#include <soxr.h>
#include <stdlib.h>
#include <string.h>

enum { FFT = 512, BANDS = 26, SLOPE = 2 };

#define LOWEST_HZ 90.0
#define HIGHEST_HZ 7600.0
#define PRE_EMPHASIS 0.97
/* Loudness is measured over this range below the loud parts (95th percentile). */
#define DEPTH_DB 45.0
/* Silence is below this share of the range from the softest to the loud. */
#define SILENT_SHARE 0.25
#define TAU 6.283185307179586

struct analysis {
    double window[FEATURE_WINDOW];
    double weight[BANDS][FFT / 2 + 1];
    double cosine[FEATURE_CEPSTRA][BANDS];
};

static double mel(double hz) {
    return 2595 * log10(1 + hz / 700);
}

static void analysis_make(struct analysis *a) {
    double low = mel(LOWEST_HZ), step = (mel(HIGHEST_HZ) - low) / (BANDS + 1);
    for (int i = 0; i < FEATURE_WINDOW; i++)
        a->window[i] = 0.5 - 0.5 * cos(TAU * (i + 0.5) / FEATURE_WINDOW);
    for (int b = 0; b < BANDS; b++)
        for (int k = 0; k <= FFT / 2; k++) {
            double x = (mel((double)k * FEATURE_RATE / FFT) - low) / step - b;
            a->weight[b][k] = fmax(0, 1 - fabs(x - 1));
        }
    for (int c = 0; c < FEATURE_CEPSTRA; c++)
        for (int b = 0; b < BANDS; b++)
            a->cosine[c][b] = cos(TAU / 2 * c * (b + 0.5) / BANDS) * sqrt(2.0 / BANDS);
}

/* Resamples to FEATURE_RATE. Free the result. */
static float *resampled(const int16_t *pcm, size_t samples, uint32_t rate, size_t *count) {
    size_t cap = (size_t)((double)samples * FEATURE_RATE / rate) + 16;
    float *out = mem_alloc(cap * sizeof *out);
    soxr_io_spec_t io = soxr_io_spec(SOXR_INT16_I, SOXR_FLOAT32_I);
    soxr_quality_spec_t quality = soxr_quality_spec(SOXR_MQ, 0);
    *count = 0;
    soxr_oneshot(rate, FEATURE_RATE, 1, pcm, samples, NULL, out, cap, count, &io, &quality, NULL);
    return out;
}

static void analyse(const struct analysis *a, const float *pcm, size_t count, ptrdiff_t centre,
                    float out[FEATURE_COUNT], double *loudness) {
    double x[FFT] = {0}, energy = 1e-10, bands[BANDS], before = 0;
    for (int i = 0; i < FEATURE_WINDOW; i++) {
        ptrdiff_t at = centre - FEATURE_WINDOW / 2 + i;
        double sample = at >= 0 && at < (ptrdiff_t)count ? pcm[at] : 0;
        energy += sample * sample * a->window[i];
        x[i] = (sample - PRE_EMPHASIS * before) * a->window[i];
        before = sample;
    }
    gsl_fft_real_radix2_transform(x, 1, FFT);
    for (int b = 0; b < BANDS; b++) {
        double power = 1e-9;
        for (int k = 1; k < FFT / 2; k++)
            power += a->weight[b][k] * (x[k] * x[k] + x[FFT - k] * x[FFT - k]);
        bands[b] = log(power);
    }
    for (int c = 1; c < FEATURE_CEPSTRA; c++) {
        double sum = 0;
        for (int b = 0; b < BANDS; b++)
            sum += a->cosine[c][b] * bands[b];
        out[c] = (float)sum;
    }
    *loudness = 10 * log10(energy / FEATURE_WINDOW);
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Scales loudness to 0 to 1 over DEPTH_DB, and marks silence. */
static void set_loudness(struct features *f, const double *loudness) {
    double *sorted = mem_alloc(f->count * sizeof *sorted);
    memcpy(sorted, loudness, f->count * sizeof *sorted);
    qsort(sorted, f->count, sizeof *sorted, compare);
    double loud = sorted[f->count * 95 / 100], soft = fmax(sorted[f->count * 2 / 100], loud - DEPTH_DB);
    free(sorted);
    for (size_t k = 0; k < f->count; k++) {
        f->frames[k][0] = (float)fmax(0, 1 + (loudness[k] - loud) / DEPTH_DB);
        f->silent[k] = loudness[k] < soft + SILENT_SHARE * (loud - soft);
    }
}

/* Normalises to mean 0 and deviation 1 over the frames that are not silent, except the loudness. */
static void normalise(struct features *f) {
    for (int c = 1; c < FEATURE_CEPSTRA; c++) {
        double sum = 0, squares = 0, n = 1e-9;
        for (size_t k = 0; k < f->count; k++)
            if (!f->silent[k]) {
                sum += f->frames[k][c];
                squares += (double)f->frames[k][c] * f->frames[k][c];
                n++;
            }
        double mean = sum / n, spread = sqrt(fmax(squares / n - mean * mean, 1e-6));
        for (size_t k = 0; k < f->count; k++)
            f->frames[k][c] = (float)fmax(-4, fmin(4, (f->frames[k][c] - mean) / spread));
    }
}

/* Regression over +-SLOPE frames. */
static void add_slopes(struct features *f) {
    for (size_t k = 0; k < f->count; k++)
        for (int c = 0; c < FEATURE_CEPSTRA; c++) {
            double sum = 0;
            for (int d = 1; d <= SLOPE; d++) {
                size_t ahead = k + (size_t)d < f->count ? k + (size_t)d : f->count - 1;
                size_t back = k >= (size_t)d ? k - (size_t)d : 0;
                sum += d * (f->frames[ahead][c] - f->frames[back][c]);
            }
            f->frames[k][FEATURE_CEPSTRA + c] = (float)(sum / 10);
        }
}

void features_make(struct features *f, const int16_t *pcm, size_t samples, uint32_t rate) {
    struct analysis *analysis = mem_alloc(sizeof *analysis);
    size_t count;
    float *sound = resampled(pcm, samples, rate, &count);
    f->count = count / FEATURE_HOP + 1;
    f->frames = mem_alloc(f->count * sizeof *f->frames);
    f->silent = mem_alloc(f->count * sizeof *f->silent);
    double *loudness = mem_alloc(f->count * sizeof *loudness);
    analysis_make(analysis);
    for (size_t k = 0; k < f->count; k++)
        analyse(analysis, sound, count, (ptrdiff_t)(k * FEATURE_HOP), f->frames[k], &loudness[k]);
    set_loudness(f, loudness);
    normalise(f);
    add_slopes(f);
    free(loudness);
    free(sound);
    free(analysis);
}

void features_free(struct features *f) {
    free(f->frames);
    free(f->silent);
    *f = (struct features){0};
}
