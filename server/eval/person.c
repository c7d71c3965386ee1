/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/person.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    if (person->phone_count && person->phones[0].start > 0) /* what comes before the first phone is a pause */
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
        mem_alloc((n + 1) * (m + 1) * sizeof *length); /* of the rest's longest common sequence */
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
    if (!to || t <= from[0]) /* outside the speech time runs as it does */
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
