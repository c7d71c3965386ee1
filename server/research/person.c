/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/person.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A curve whose standard deviation is below this share of its magnitude is constant: the rest is rounding. */
#define STILL 1e-9

struct curve_match curve_match(const double *y, const double *f, size_t count) {
    struct curve_match out = {count, NAN, NAN, NAN};
    double my = 0, mf = 0, yy = 0, ff = 0, yf = 0, dd = 0, n = (double)count;
    if (!count)
        return out;
    for (size_t i = 0; i < count; i++) {
        my += y[i] / n;
        mf += f[i] / n;
    }
    for (size_t i = 0; i < count; i++) {
        double a = y[i] - my, b = f[i] - mf;
        yy += a * a / n;
        ff += b * b / n;
        yf += a * b / n;
        dd += (a - b) * (a - b) / n;
    }
    out.offset_rms = sqrt(dd);
    out.affine_rms = sqrt(yy);
    if (sqrt(yy) > STILL * (1 + fabs(my)) && sqrt(ff) > STILL * (1 + fabs(mf))) {
        out.correlation = yf / sqrt(yy * ff);
        out.affine_rms = sqrt(fmax(0, yy - yf * yf / ff));
    }
    return out;
}

struct curve_match_shifted curve_match_shifted(const double *times, const double *y, size_t count,
                                               double (*predict)(void *ctx, double t), void *ctx,
                                               double always) {
    struct curve_match_shifted out = {0};
    double *f = mem_alloc((count + 1) * sizeof *f);
    int steps = (int)lround(CURVE_SHIFT_MOST / CURVE_SHIFT_STEP);
    for (int s = -steps - 1; s <= steps; s++) {
        double shift = s < -steps ? 0 : s * CURVE_SHIFT_STEP; /* first without a shift */
        for (size_t i = 0; i < count; i++)
            f[i] = predict(ctx, times[i] - always - shift);
        struct curve_match m = curve_match(y, f, count);
        if (s < -steps)
            out.as_is = out.best = m;
        else if (m.correlation > out.best.correlation) {
            out.best = m;
            out.shift = shift;
        }
    }
    free(f);
    return out;
}

const char *const person_measures[PERSON_MEASURES] = {"LI", "LS", "AR", "PI", "PS",
                                                      "EM", "TH", "TA", "TB", "aperture"};

/* Fine enough for any recording. */
enum { TICKS = 100000 };

bool person_has(const struct measured_speech *person, int measure) {
    return measure == PERSON_APERTURE ? person->curves[PARAM_LI] && person->curves[PARAM_LS]
                                      : person->curves[measure] != NULL;
}

static double curve_between(const struct measured_speech *person, int p, double t) {
    const double *times = person->times, *y = person->curves[p];
    size_t low = 0, high = person->frame_count - 1;
    if (t <= times[0])
        return y[0];
    if (t >= times[high])
        return y[high];
    while (low + 1 < high) {
        size_t middle = (low + high) / 2;
        if (times[middle] <= t)
            low = middle;
        else
            high = middle;
    }
    return y[low] + (t - times[low]) / (times[high] - times[low]) * (y[high] - y[low]);
}

double person_at(const struct measured_speech *person, int measure, double t) {
    return measure == PERSON_APERTURE
               ? curve_between(person, PARAM_LI, t) + curve_between(person, PARAM_LS, t)
               : curve_between(person, measure, t);
}

void person_speech(const struct measured_speech *person, double *start, double *end) {
    *start = *end = 0;
    for (size_t i = 0; i < person->phone_count; i++) {
        if (!person->phones[i].ipa[0])
            continue;
        *start = *end > 0 ? *start : person->phones[i].start;
        *end = person->phones[i].end;
    }
}

struct sentence_audio *person_audio(const struct measured_speech *person) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    u->sample_rate = TICKS;
    u->phones = mem_alloc((person->phone_count + 2) * sizeof *u->phones);
    if (person->phone_count && person->phones[0].start > 0) /* sound before the first phone is a pause */
        u->phones[u->phone_count++] =
            (struct phone){.end = (uint32_t)lround(person->phones[0].start * TICKS)};
    for (size_t i = 0; i < person->phone_count; i++) {
        const struct recorded_phone *from = &person->phones[i];
        struct phone *to = &u->phones[u->phone_count++];
        *to = (struct phone){.start = (uint32_t)lround(from->start * TICKS),
                             .end = (uint32_t)lround(from->end * TICKS),
                             .stress = from->stress};
        snprintf(to->ipa, sizeof to->ipa, "%s", from->ipa);
        u->samples = to->end;
    }
    return u;
}

void person_audio_free(struct sentence_audio *audio) {
    free(audio->phones);
    free(audio);
}

double person_face_at(void *person_face, double t) {
    const struct person_face *f = person_face;
    struct fap_frame frame;
    double mm[PARAM_COUNT];
    f->face.sample(f->face.self, t, &frame);
    fapmap_read(&f->pack->fapu, &frame, mm);
    return f->measure == PERSON_APERTURE ? mm[PARAM_LI] + mm[PARAM_LS] : mm[f->measure];
}

static bool same_phone(const struct recorded_phone *a, const struct recorded_phone *b) {
    return a->ipa[0] && !strcmp(a->ipa, b->ipa);
}

static void add_anchor(struct person_warp *warp, double t, double other) {
    const double *last = warp->count ? warp->anchors[warp->count - 1] : NULL;
    if (last && (t <= last[0] + 1e-6 || other <= last[1] + 1e-6))
        return;
    warp->anchors[warp->count][0] = t;
    warp->anchors[warp->count++][1] = other;
}

void person_warp_new(struct person_warp *warp, const struct measured_speech *person,
                     const struct measured_speech *other) {
    size_t n = person->phone_count, m = other->phone_count;
    uint32_t *length =
        mem_alloc((n + 1) * (m + 1) * sizeof *length); /* of the longest common sequence of the rest */
    *warp = (struct person_warp){.other = other, .anchors = mem_alloc((2 * n + 2) * sizeof *warp->anchors)};
    for (size_t i = n; i-- > 0;)
        for (size_t k = m; k-- > 0;) {
            uint32_t down = length[(i + 1) * (m + 1) + k], right = length[i * (m + 1) + k + 1];
            length[i * (m + 1) + k] = same_phone(&person->phones[i], &other->phones[k])
                                          ? length[(i + 1) * (m + 1) + k + 1] + 1
                                      : down > right ? down
                                                     : right;
        }
    for (size_t i = 0, k = 0; i < n && k < m;) {
        if (same_phone(&person->phones[i], &other->phones[k])) {
            add_anchor(warp, person->phones[i].start, other->phones[k].start);
            add_anchor(warp, person->phones[i].end, other->phones[k].end);
            warp->matched++;
            i++;
            k++;
        } else if (length[(i + 1) * (m + 1) + k] >= length[i * (m + 1) + k + 1]) {
            i++;
        } else {
            k++;
        }
    }
    free(length);
}

double person_warp_time(const struct person_warp *warp, double t) {
    size_t i = 1;
    if (!warp->count)
        return t;
    while (i < warp->count && warp->anchors[i][0] < t)
        i++;
    const double *from = warp->anchors[i - 1], *to = i < warp->count ? warp->anchors[i] : NULL;
    if (!to || t <= from[0]) /* outside the speech, times differ by a constant */
        return from[1] + t - from[0];
    return from[1] + (t - from[0]) / (to[0] - from[0]) * (to[1] - from[1]);
}

double person_warp_at(void *person_warp, double t) {
    const struct person_warp *warp = person_warp;
    return person_at(warp->other, warp->measure, person_warp_time(warp, t));
}

void person_warp_free(struct person_warp *warp) {
    free(warp->anchors);
    *warp = (struct person_warp){0};
}

struct curve_match_shifted person_match(const struct measured_speech *person, int measure,
                                        double (*predict)(void *ctx, double t), void *ctx, double always) {
    double start, end;
    double *times = mem_alloc((person->frame_count + 1) * sizeof *times),
           *y = mem_alloc((person->frame_count + 1) * sizeof *y);
    size_t count = 0;
    person_speech(person, &start, &end);
    for (size_t i = 0; i < person->frame_count; i++) {
        double t = person->times[i];
        if (t < start || t > end)
            continue;
        times[count] = t;
        y[count++] = person_at(person, measure, t);
    }
    struct curve_match_shifted out = curve_match_shifted(times, y, count, predict, ctx, always);
    free(times);
    free(y);
    return out;
}

/* Lips and jaw only: the tongue is invisible, and the aperture is a sum of two others. */
enum { SEEN = PARAM_EM + 1, PLACES = 3 };
_Static_assert(PLACES *SEEN <= READER_FEATURES, "there are too many features");
#define STEP 0.01 /* s, sampling interval for mean and deviation */

struct norm {
    double mean, deviation;
};

static struct norm norm_of(const struct person_mouth *mouth, int measure) {
    double sum = 0, squares = 0, n = 0;
    const struct phone_segments *g = mouth->segments;
    for (size_t i = 0; i < g->count; i++)
        for (double t = g->items[i].start; g->items[i].phone && t < g->items[i].end; t += STEP) {
            double y = mouth->at(mouth->ctx, measure, t);
            sum += y;
            squares += y * y;
            n++;
        }
    double mean = n > 0 ? sum / n : 0, variance = n > 0 ? squares / n - mean * mean : 0;
    return (struct norm){mean, variance > 1e-12 ? sqrt(variance) : 1};
}

static double middle(const struct phone_segments *g, size_t i) {
    return (g->items[i].start + g->items[i].end) / 2;
}

void person_reader_add(struct lip_reader *reader, int half, const struct person_mouth *mouth,
                       const bool use[PERSON_MEASURES]) {
    const struct phone_segments *g = mouth->segments;
    struct norm norms[SEEN];
    for (int p = 0; p < SEEN; p++)
        norms[p] = use[p] ? norm_of(mouth, p) : (struct norm){0, 1};
    for (size_t i = 0; i < g->count; i++) {
        if (!g->items[i].phone)
            continue;
        struct lip_reader_sample sample = {.class = g->items[i].phone->group};
        double at[PLACES] = {i ? middle(g, i - 1) : g->items[i].start, middle(g, i),
                             i + 1 < g->count ? middle(g, i + 1) : g->items[i].end};
        for (int place = 0; place < PLACES; place++)
            for (int p = 0; p < SEEN; p++)
                if (use[p])
                    sample.features[place * SEEN + p] =
                        (float)((mouth->at(mouth->ctx, p, at[place]) - norms[p].mean) / norms[p].deviation);
        lip_reader_add(reader, half, &sample);
    }
}
