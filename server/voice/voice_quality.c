/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/voice_quality.h"
#include "server/base/mem.h"
#include "server/base/smoothstep.h"
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define RAMP_SECONDS 0.02
#define PEAK_MOST 29204 /* 1 dB below full scale; a voice that was louder keeps its peak */

/* A stretch while it is changed. */
struct stretch {
    const struct score_quality *quality;
    double rate;    /* Hz */
    size_t count;   /* samples */
    float *was, *x; /* as spoken, and changed so far */
    float *voiced;  /* 0..1, of each sample */
    size_t hop, hops;
    float *period; /* samples, of each hop; 0 = voiceless */
    uint32_t seed;
};

/* Xorshift of G. Marsaglia, 2003; -1..1, uniform. */
static double noise(struct stretch *s) {
    s->seed ^= s->seed << 13;
    s->seed ^= s->seed >> 17;
    s->seed ^= s->seed << 5;
    return s->seed / 2147483648.0 - 1;
}

static double energy(const float *x, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += (double)x[i] * x[i];
    return sum;
}

/* ---- pitch: normalised cross-correlation of the sound at about 4 kHz ---- */

enum {
    TRACK_RATE = 4000,
    LAG_MIN = 8,
    LAG_MAX = 60 /* 67 to 500 Hz */,
    TRACK_WINDOW = 120,
    HOPS_A_SECOND = 100
};
#define VOICED_LEAST 0.55  /* correlation of a voiced sound */
#define OCTAVE_SHARE 0.9   /* of the best correlation: a shorter period that reaches it is taken */
#define SILENCE_SHARE 1e-4 /* of the loudest window's energy */

static float *decimate(const struct stretch *s, size_t step, size_t *count) {
    *count = s->count / step;
    float *low = mem_alloc((*count + LAG_MAX + TRACK_WINDOW + 1) * sizeof *low);
    for (size_t i = 0; i < *count; i++) {
        double sum = 0;
        for (size_t k = 0; k < step; k++)
            sum += s->was[i * step + k];
        low[i] = (float)(sum / (double)step);
    }
    return low;
}

/* Returns the period in samples of the low rate, or 0. */
static double period_at(const float *x) {
    double r[LAG_MAX + 1] = {0}, best = 0, own = energy(x, TRACK_WINDOW);
    for (size_t lag = LAG_MIN; lag <= LAG_MAX; lag++) {
        double sum = 0, other = energy(x + lag, TRACK_WINDOW);
        for (size_t i = 0; i < TRACK_WINDOW; i++)
            sum += (double)x[i] * x[i + lag];
        r[lag] = own > 0 && other > 0 ? sum / sqrt(own * other) : 0;
        best = fmax(best, r[lag]);
    }
    if (best < VOICED_LEAST)
        return 0;
    for (size_t lag = LAG_MIN + 1; lag < LAG_MAX; lag++)
        if (r[lag] >= OCTAVE_SHARE * best && r[lag] >= r[lag - 1] && r[lag] >= r[lag + 1]) {
            double bend = r[lag - 1] - 2 * r[lag] + r[lag + 1];
            return (double)lag + (bend < 0 ? (r[lag - 1] - r[lag + 1]) / 2 / bend : 0);
        }
    return 0;
}

static void track_pitch(struct stretch *s) {
    size_t step = (size_t)fmax(1, floor(s->rate / TRACK_RATE)), count;
    float *low = decimate(s, step, &count);
    double loudest = 0;
    s->hop = (size_t)(s->rate / HOPS_A_SECOND);
    s->hops = s->count / s->hop + 1;
    s->period = mem_alloc(s->hops * sizeof *s->period);
    s->voiced = mem_alloc((s->count + 1) * sizeof *s->voiced);
    for (size_t i = 0; i + TRACK_WINDOW <= count; i += TRACK_WINDOW)
        loudest = fmax(loudest, energy(low + i, TRACK_WINDOW));
    for (size_t h = 0; h < s->hops; h++) {
        size_t at = h * s->hop / step, half = TRACK_WINDOW / 2 + LAG_MIN;
        at = at > half ? at - half : 0;
        if (at < count && energy(low + at, TRACK_WINDOW) > SILENCE_SHARE * loudest)
            s->period[h] = (float)(period_at(low + at) * (double)step);
    }
    free(low);
    /* a one-pole filter in both directions smooths the changes over about 10 ms */
    double slow = exp(-1 / (0.005 * s->rate)), value = 0;
    for (size_t i = 0; i < s->count; i++) {
        value = slow * value + (1 - slow) * (s->period[i / s->hop] > 0);
        s->voiced[i] = (float)value;
    }
    for (size_t i = s->count; i--;) {
        value = slow * value + (1 - slow) * s->voiced[i];
        s->voiced[i] = (float)value;
    }
}

/* ---- time: jitter from period to period, and a slow flutter ---- */

/* Klatt and Klatt, "Analysis, synthesis, and perception of voice quality variations", JASA 87, 1990: the
 * flutter of F0 as a sum of three sines. */
static const double flutter_hz[] = {12.7, 7.1, 4.7};
enum { FLUTTERS = sizeof flutter_hz / sizeof *flutter_hz, TAPS = 8, PHASES = 128 };

/* Share of the jitter that a random delay of each period makes: the mean difference of successive periods is
 * 1.95 standard deviations of the delays, and linear ramps between them keep about three quarters of it. */
#define JITTER_DELAY 0.68

/* One random number for each period, linear between: standard deviation 1, 0 where voiceless. */
static void each_period(struct stretch *s, float *out) {
    double from = 0, to;
    for (size_t at = 0; at < s->count; from = to) {
        double period = s->period[at / s->hop];
        size_t steps = (size_t)(period > 0 ? period : (double)s->hop);
        to = period > 0 ? sqrt(3) * noise(s) : 0;
        for (size_t i = 0; i < steps && at < s->count; i++, at++)
            out[at] = (float)(from + (to - from) * (double)i / (double)steps);
    }
}

static double flutter(double seconds) {
    double sum = 0;
    for (int i = 0; i < FLUTTERS; i++)
        sum += sin(2 * M_PI * flutter_hz[i] * seconds);
    return sum / FLUTTERS;
}

/* Seconds by which a flutter of share 1 delays the sound. */
static double flutter_delay(double seconds) {
    double sum = 0;
    for (int i = 0; i < FLUTTERS; i++)
        sum += (cos(2 * M_PI * flutter_hz[i] * seconds) - 1) / (2 * M_PI * flutter_hz[i]);
    return sum / FLUTTERS;
}

static void make_sinc(float table[PHASES + 1][TAPS]) {
    for (int p = 0; p <= PHASES; p++)
        for (int k = 0; k < TAPS; k++) {
            double t = k - (TAPS / 2 - 1) - (double)p / PHASES, window = 0.5 + 0.5 * cos(2 * M_PI * t / TAPS);
            table[p][k] = (float)(fabs(t) < 1e-9         ? 1
                                  : fabs(t) < TAPS / 2.0 ? window * sin(M_PI * t) / (M_PI * t)
                                                         : 0);
        }
}

static float sample_at(const struct stretch *s, const float table[PHASES + 1][TAPS], double at) {
    double whole = floor(at), sum = 0;
    const float *sinc = table[(int)lround((at - whole) * PHASES)];
    long first = (long)whole - (TAPS / 2 - 1);
    for (long k = 0; k < TAPS; k++)
        if (first + k >= 0 && first + k < (long)s->count)
            sum += (double)sinc[k] * s->was[first + k];
    return (float)sum;
}

static void bend_time(struct stretch *s) {
    const struct score_quality *q = s->quality;
    float table[PHASES + 1][TAPS], *random;
    if (q->jitter <= 0 && q->flutter <= 0)
        return;
    random = mem_alloc((s->count + 1) * sizeof *random);
    make_sinc(table);
    each_period(s, random);
    for (size_t i = 0; i < s->count; i++) {
        double period = s->period[i / s->hop];
        double delay = q->jitter * JITTER_DELAY * period * random[i] +
                       q->flutter * s->rate * flutter_delay((double)i / s->rate);
        s->x[i] = sample_at(s, table, (double)i - delay);
    }
    free(random);
}

/* ---- amplitude ---- */

static void shake(struct stretch *s) {
    const struct score_quality *q = s->quality;
    float *random;
    if (q->shimmer <= 0 && q->tremor <= 0)
        return;
    random = mem_alloc((s->count + 1) * sizeof *random);
    each_period(s, random);
    /* the mean difference of independent neighbours is 1.13 standard deviations; ramps halve it */
    for (size_t i = 0; i < s->count; i++)
        s->x[i] *= (float)(pow(10, q->shimmer * 1.4 * random[i] / 20) *
                           (1 + q->tremor * s->voiced[i] * flutter((double)i / s->rate + 0.05)));
    free(random);
}

/* ---- spectrum ---- */

/* A slope of any number of dB per octave from poles an octave apart, each with a zero in between (J. O. Smith
 * and H. F. Smith, "Closed form fractional integration and differentiation via real exponentially spaced
 * pole-zero pairs", 2016). */
enum { TILT_POLES = 7 };
#define TILT_FROM 100.0    /* Hz */
#define TILT_EVEN 400.0    /* Hz: unchanged there */
#define VOICELESS_TILT 0.3 /* share of the change for voiceless sounds, which a voice affects less */

struct tilt_section {
    double b0, b1, a1, before_in, before_out;
};

static double warped(double hz, double rate) {
    return tan(M_PI * fmin(hz, 0.45 * rate) / rate);
}

static double section_gain(const struct tilt_section *t, double hz, double rate) {
    double w = 2 * M_PI * hz / rate, c = cos(w), s = sin(w);
    return hypot(t->b0 + t->b1 * c, t->b1 * s) / hypot(1 + t->a1 * c, t->a1 * s);
}

static void tilt(struct stretch *s) {
    struct tilt_section sections[TILT_POLES];
    double octaves = -s->quality->tilt / (20 * log10(2)), gain = 1;
    if (s->quality->tilt == 0)
        return;
    for (int i = 0; i < TILT_POLES; i++) {
        double hz = TILT_FROM * pow(2, i), p = warped(hz, s->rate), z = warped(hz * pow(2, octaves), s->rate);
        sections[i] = (struct tilt_section){
            .b0 = p / z * (1 + z) / (1 + p), .b1 = p / z * (z - 1) / (1 + p), .a1 = (p - 1) / (1 + p)};
        gain /= section_gain(&sections[i], TILT_EVEN, s->rate);
    }
    for (size_t n = 0; n < s->count; n++) {
        double value = s->x[n] * gain, share = VOICELESS_TILT + (1 - VOICELESS_TILT) * s->voiced[n];
        for (int i = 0; i < TILT_POLES; i++) {
            struct tilt_section *t = &sections[i];
            double out = t->b0 * value + t->b1 * t->before_in - t->a1 * t->before_out;
            t->before_in = value;
            value = t->before_out = out;
        }
        s->x[n] += (float)(share * (value - s->x[n]));
    }
}

/* ---- breath: noise through the vocal tract as linear prediction finds it ---- */

enum { PREDICTION_MAX = 26, WARM_UP = 200 };
#define BREATH_SECONDS 0.025 /* of a window; they overlap by half */
#define BREATH_SLOPE 0.9     /* first difference: noise of the glottis has little at the low harmonics */
#define WHITE 1.0001         /* noise floor of the prediction, -40 dB */

/* Levinson and Durbin: a[1..order] of the filter 1 / (1 + sum a z^-k). */
static void predict(const double *r, int order, double *a) {
    double error = r[0] * WHITE, before[PREDICTION_MAX + 1];
    for (int i = 1; i <= order; i++)
        a[i] = 0;
    for (int i = 1; i <= order && error > 0; i++) {
        double k = r[i];
        for (int j = 1; j < i; j++)
            k += a[j] * r[i - j];
        k = -k / error;
        memcpy(before, a, sizeof before);
        for (int j = 1; j < i; j++)
            a[j] = before[j] + k * before[i - j];
        a[i] = k;
        error *= 1 - k * k;
    }
}

/* Writes the noise of one window, of the energy of the sound in it. */
static void breathe(struct stretch *s, const float *sound, size_t length, float *out) {
    int order = (int)fmin(PREDICTION_MAX, 2 + s->rate / 1000);
    double r[PREDICTION_MAX + 1] = {0}, a[PREDICTION_MAX + 1] = {1}, history[PREDICTION_MAX] = {0}, last = 0;
    for (int k = 0; k <= order; k++)
        for (size_t i = (size_t)k; i < length; i++)
            r[k] += (double)sound[i] * sound[i - (size_t)k];
    predict(r, order, a);
    for (size_t i = 0; i < WARM_UP + length; i++) {
        double white = noise(s), value = white - BREATH_SLOPE * last;
        last = white;
        for (int k = 1; k <= order; k++)
            value -= a[k] * history[(i + PREDICTION_MAX * WARM_UP - (size_t)k) % PREDICTION_MAX];
        history[i % PREDICTION_MAX] = value;
        if (i >= WARM_UP)
            out[i - WARM_UP] = (float)value;
    }
    double have = energy(out, length), gain = have > 0 ? sqrt(r[0] / have) : 0;
    for (size_t i = 0; i < length; i++)
        out[i] *= (float)gain;
}

static void aspirate(struct stretch *s) {
    size_t half = (size_t)(BREATH_SECONDS * s->rate / 2), length = 2 * half;
    double share = s->quality->aspiration;
    float *sound, *breath, *all;
    if (share <= 0)
        return;
    sound = mem_alloc(length * sizeof *sound);
    breath = mem_alloc(length * sizeof *breath);
    all = mem_alloc((s->count + length) * sizeof *all);
    for (size_t at = 0; at < s->count; at += half) {
        bool heard = false;
        for (size_t i = 0; i < length; i++) {
            size_t n = at + i;
            double window = 0.5 - 0.5 * cos(M_PI * ((double)i + 0.5) / (double)half);
            sound[i] = n >= half && n - half < s->count ? (float)(window * s->x[n - half]) : 0;
            heard |= n >= half && n - half < s->count && s->voiced[n - half] > 0.01F;
        }
        if (!heard)
            continue;
        breathe(s, sound, length, breath);
        /* noise of neighbouring windows adds in power: the sine window keeps it even */
        for (size_t i = 0; i < length; i++)
            if (at + i >= half && at + i - half < s->count)
                all[at + i - half] += (float)(breath[i] * sin(M_PI * ((double)i + 0.5) / (double)length));
    }
    /* the energy of a Hann window is 3/8 of the sound's */
    for (size_t n = 0; n < s->count; n++) {
        double here = share * s->voiced[n];
        s->x[n] = (float)(s->x[n] * sqrt(1 - here) + all[n] * sqrt(here * 8 / 3));
    }
    free(all);
    free(breath);
    free(sound);
}

/* ---- all together ---- */

/* Blends the changed sound in, no louder than before. */
static void blend(struct stretch *s, size_t lead, size_t tail, int16_t *pcm) {
    double ramp = RAMP_SECONDS * s->rate, before = energy(s->was, s->count), after = energy(s->x, s->count);
    double gain = after > 0 ? sqrt(before / after) : 0, peak = 0, changed = 0;
    for (size_t i = 0; i < s->count; i++) {
        peak = fmax(peak, fabs(s->was[i]));
        changed = fmax(changed, fabs(s->x[i]));
    }
    peak = fmax(peak, PEAK_MOST);
    if (changed * gain > peak)
        gain = peak / changed;
    for (size_t i = 0; i < s->count; i++) {
        double share = (lead ? smoothstep((double)i / ramp) : 1) *
                       (tail ? smoothstep((double)(s->count - 1 - i) / ramp) : 1);
        double value = s->was[i] + share * (gain * s->x[i] - s->was[i]);
        pcm[i] = (int16_t)lrint(fmax(-peak, fmin(peak, value)));
    }
}

static bool is_modal(const struct score_quality *q) {
    return q->tilt == 0 && q->aspiration <= 0 && q->jitter <= 0 && q->shimmer <= 0 && q->flutter <= 0 &&
           q->tremor <= 0;
}

void voice_quality_apply(int16_t *pcm, uint32_t samples, uint32_t sample_rate, uint32_t from, uint32_t to,
                         const struct score_quality *quality) {
    uint32_t ramp = (uint32_t)(RAMP_SECONDS / 2 * sample_rate);
    to = to < samples ? to : samples;
    if (is_modal(quality) || from >= to || sample_rate < 2 * TRACK_RATE)
        return;
    from = from > ramp ? from - ramp : 0;
    to = samples - to > ramp ? to + ramp : samples;
    struct stretch s = {.quality = quality, .rate = sample_rate, .count = to - from, .seed = 0x2545f491};
    s.was = mem_alloc(s.count * sizeof *s.was);
    s.x = mem_alloc(s.count * sizeof *s.x);
    for (size_t i = 0; i < s.count; i++)
        s.x[i] = s.was[i] = pcm[from + i];
    track_pitch(&s);
    bend_time(&s);
    shake(&s);
    tilt(&s);
    aspirate(&s);
    blend(&s, from, samples - to, pcm + from);
    free(s.was);
    free(s.x);
    free(s.period);
    free(s.voiced);
}
