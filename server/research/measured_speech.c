/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/measured_speech.h"
#include "server/base/mem.h"
#include <ctype.h>
#include <gsl/gsl_interp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name, *ipa;
} names[] = {
    {"aa", "ɑː"},
    {"ae", "æ"},
    {"ah", "ʌ"},
    {"ao", "ɔː"},
    {"aw", "aʊ"},
    {"ax", "ə"},
    {"axr", "ɚ"},
    {"ay", "aɪ"},
    {"eh", "ɛ"},
    {"er", "ɜː"},
    {"ey", "eɪ"},
    {"ih", "ɪ"},
    {"ix", "ɪ"},
    {"iy", "iː"},
    {"ow", "oʊ"},
    {"oy", "ɔɪ"},
    {"uh", "ʊ"},
    {"uw", "uː"},
    {"ux", "uː"},
    {"ax-h", "ə"},
    {"b", "b"},
    {"ch", "tʃ"},
    {"d", "d"},
    {"dh", "ð"},
    {"dx", "ɾ"},
    {"el", "l"},
    {"em", "m"},
    {"en", "n"},
    {"eng", "ŋ"},
    {"f", "f"},
    {"g", "ɡ"},
    {"hh", "h"},
    {"hv", "h"},
    {"h", "h"},
    {"jh", "dʒ"},
    {"k", "k"},
    {"l", "l"},
    {"m", "m"},
    {"n", "n"},
    {"ng", "ŋ"},
    {"nx", "n"},
    {"p", "p"},
    {"q", "ʔ"},
    {"r", "ɹ"},
    {"s", "s"},
    {"sh", "ʃ"},
    {"t", "t"},
    {"th", "θ"},
    {"v", "v"},
    {"w", "w"},
    {"wh", "w"},
    {"y", "j"},
    {"z", "z"},
    {"zh", "ʒ"},
    /* closures of stops, which TIMIT labels separately */
    {"bcl", "b"},
    {"dcl", "d"},
    {"gcl", "ɡ"},
    {"kcl", "k"},
    {"pcl", "p"},
    {"tcl", "t"},
    {"sil", ""},
    {"sp", ""},
    {"spn", ""},
    {"pau", ""},
    {"epi", ""},
    {"h#", ""},
};

static bool is_same(const char *name, size_t length, const char *entry) {
    for (size_t i = 0; i < length; i++)
        if (tolower((unsigned char)name[i]) != entry[i])
            return false;
    return !entry[length];
}

const char *arpabet_ipa(const char *name, uint8_t *stress) {
    size_t length = strlen(name);
    *stress = 0;
    if (length > 2 && name[length - 1] >= '0' && name[length - 1] <= '2') {
        static const uint8_t levels[] = {0, 2, 1};
        *stress = levels[name[length - 1] - '0'];
        length--;
    }
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (is_same(name, length, names[i].name)) /* an unstressed AH is a schwa */
            return !strcmp(names[i].name, "ah") && name[length] == '0' ? "ə" : names[i].ipa;
    return NULL;
}

bool arpabet_is_telling(const char *name) {
    uint8_t stress;
    const char *ipa = arpabet_ipa(name, &stress);
    return ipa && *ipa && strlen(name) > 1;
}

/* Tolerance for rounded times. */
#define SAME_TIME 1e-3
/* Curves may be shorter than the phones by this, s: two frames. */
#define SHORT_CURVES 0.02
#define LONGEST 3600 /* s */
/* Cubic splines need three points. */
enum { LEAST_FRAMES = 3 };

void measured_speech_free(struct measured_speech *r) {
    free(r->phones);
    free(r->times);
    for (int p = 0; p < PARAM_COUNT; p++) {
        free(r->curves[p]);
        free(r->spread[p]);
        free(r->unseen[p]);
    }
    *r = (struct measured_speech){0};
}

void measured_speech_free_all(struct measured_speech *list, size_t count) {
    for (size_t i = 0; i < count; i++)
        measured_speech_free(&list[i]);
    free(list);
}

static void put_phone(struct measured_speech *r, const struct recorded_phone *phone) {
    r->phones = mem_grow(r->phones, &r->phone_cap, r->phone_count + 1, sizeof *r->phones);
    r->phones[r->phone_count++] = *phone;
}

int measured_speech_add(struct measured_speech *r, const struct recorded_phone *phone, struct error *e) {
    struct recorded_phone own = *phone;
    if (!(own.end > own.start) || !(own.start >= 0) || !(own.end <= LONGEST))
        return error_set(e, ERROR_BAD_CURVES, "phone %zu: must end after it starts, and within an hour",
                         r->phone_count + 1);
    double last = r->phone_count ? r->phones[r->phone_count - 1].end : own.start;
    if (own.start < last - SAME_TIME)
        return error_set(e, ERROR_BAD_CURVES, "phone %zu: starts before the end of the one before it",
                         r->phone_count + 1);
    if (own.start > last + SAME_TIME) {
        struct recorded_phone gap = {.start = last, .end = own.start};
        put_phone(r, &gap);
    } else {
        own.start = last;
    }
    put_phone(r, &own);
    return 0;
}

static const struct recorded_phone *last_phone(const struct measured_speech *r) {
    return &r->phones[r->phone_count - 1];
}

static double mean_within(const struct measured_speech *r, const double *curve, double from, double to,
                          double from2, double to2) {
    double sum = 0;
    size_t n = 0;
    for (size_t i = 0; i < r->frame_count; i++) {
        double t = r->times[i];
        if ((t >= from && t <= to) || (t >= from2 && t <= to2)) {
            sum += curve[i];
            n++;
        }
    }
    return n ? sum / (double)n : 0;
}

int measured_speech_check(const struct measured_speech *r, struct error *e) {
    size_t spoken = 0;
    for (size_t i = 0; i < r->phone_count; i++)
        spoken += r->phones[i].ipa[0] != '\0';
    if (!spoken)
        return error_set(e, ERROR_BAD_CURVES, "there are no phones except pauses");
    if (r->frame_count < LEAST_FRAMES)
        return error_set(e, ERROR_BAD_CURVES, "there are fewer than %d frames", LEAST_FRAMES);
    /* surrounding pauses may be longer than the curves */
    double start = r->phones[0].ipa[0] ? r->phones[0].start : r->phones[0].end,
           end = last_phone(r)->ipa[0] ? last_phone(r)->end : last_phone(r)->start;
    if (r->times[0] > start + SHORT_CURVES || r->times[r->frame_count - 1] < end - SHORT_CURVES)
        return error_set(e, ERROR_BAD_CURVES, "the curves do not cover the phones, %.3f to %.3f s", start,
                         end);
    return 0;
}

int measured_speech_subtract_rest(struct measured_speech *r, const struct speech_rest *rest,
                                  struct error *e) {
    if (r->phone_count < 3 || r->phones[0].ipa[0] || last_phone(r)->ipa[0])
        return error_set(e, ERROR_BAD_CURVES,
                         "must begin and end with a pause, so that the mouth can be seen at rest");
    /* Pauses may be longer than the curves, which must show a part of both. */
    double first_end = r->phones[0].end, last_start = last_phone(r)->start;
    if (r->frame_count < LEAST_FRAMES || r->times[0] >= first_end ||
        r->times[r->frame_count - 1] <= last_start)
        return error_set(e, ERROR_BAD_CURVES,
                         "the curves do not cover the phones with some of the pauses, %.3f to %.3f s",
                         first_end, last_start);
    double start = fmax(r->phones[0].start, r->times[0]),
           end = fmin(last_phone(r)->end, r->times[r->frame_count - 1]);
    /* A third of a pause that is too short for rest is better than nothing. */
    double until = fmax(start + (first_end - start) / 3, first_end - rest->leave),
           since = fmin(end - (end - last_start) / 3, last_start + rest->reach);
    for (int p = 0; p < PARAM_COUNT; p++) {
        if (!r->curves[p])
            continue;
        double level = mean_within(r, r->curves[p], start, until, since, end);
        for (size_t i = 0; i < r->frame_count; i++)
            r->curves[p][i] -= level;
    }
    return 0;
}

static double spoken_time(const struct measured_speech *r) {
    double sum = 0;
    for (size_t i = 0; i < r->phone_count; i++)
        if (r->phones[i].ipa[0])
            sum += r->phones[i].end - r->phones[i].start;
    return sum;
}

static bool repeats(const struct measured_speech *a, const struct measured_speech *b) {
    if (a->phone_count != b->phone_count)
        return false;
    for (size_t i = 0; i < a->phone_count; i++)
        if (strcmp(a->phones[i].ipa, b->phones[i].ipa) != 0 || a->phones[i].stress != b->phones[i].stress)
            return false;
    double x = spoken_time(a), y = spoken_time(b);
    return fmax(x, y) <= RECORDING_SAME_RATE * fmin(x, y);
}

/* Averages the phones' lengths, from 0 s. */
static void average_phones(const struct measured_speech *const *same, size_t count,
                           struct measured_speech *out) {
    double at = 0;
    for (size_t i = 0; i < same[0]->phone_count; i++) {
        struct recorded_phone phone = same[0]->phones[i];
        double length = 0;
        for (size_t k = 0; k < count; k++)
            length += same[k]->phones[i].end - same[k]->phones[i].start;
        phone.start = at;
        phone.end = at += length / (double)count;
        put_phone(out, &phone);
    }
}

/* Time in r that corresponds to t in the mean. */
static double warp(const struct measured_speech *mean, const struct measured_speech *r, double t) {
    size_t i = 0;
    while (i + 1 < mean->phone_count && t >= mean->phones[i].end)
        i++;
    const struct recorded_phone *m = &mean->phones[i], *own = &r->phones[i];
    double own_time = own->start + (t - m->start) / (m->end - m->start) * (own->end - own->start);
    return fmin(fmax(own_time, r->times[0]), r->times[r->frame_count - 1]);
}

/* Samples a recording's curve at the frames of the mean. */
static void resample(const struct measured_speech *mean, const struct measured_speech *r, int p,
                     double *out) {
    gsl_interp *spline = gsl_interp_alloc(gsl_interp_cspline, r->frame_count);
    gsl_interp_accel *place = gsl_interp_accel_alloc();
    gsl_interp_init(spline, r->times, r->curves[p], r->frame_count);
    for (size_t i = 0; i < mean->frame_count; i++)
        out[i] = gsl_interp_eval(spline, r->times, r->curves[p], warp(mean, r, mean->times[i]), place);
    gsl_interp_accel_free(place);
    gsl_interp_free(spline);
}

/* Mean and standard deviation of the repetitions. */
static void add_curves(struct measured_speech *mean, const struct measured_speech *const *same, size_t count,
                       int p) {
    size_t frames = mean->frame_count;
    double *curves = mem_alloc(count * frames * sizeof *curves);
    mean->curves[p] = mem_alloc(frames * sizeof(double));
    mean->spread[p] = count > 1 ? mem_alloc(frames * sizeof(double)) : NULL;
    for (size_t k = 0; k < count; k++)
        resample(mean, same[k], p, curves + k * frames);
    for (size_t i = 0; i < frames; i++) {
        double squares = 0;
        for (size_t k = 0; k < count; k++)
            mean->curves[p][i] += curves[k * frames + i] / (double)count;
        for (size_t k = 0; k < count; k++)
            squares += pow(curves[k * frames + i] - mean->curves[p][i], 2);
        if (count > 1)
            mean->spread[p][i] = sqrt(squares / (double)(count - 1));
    }
    free(curves);
}

/* Marks the frames of the mean that are missing in r, by r's nearest frame. */
static void add_unseen(struct measured_speech *mean, const struct measured_speech *r, int p) {
    size_t k = 0;
    if (!r->unseen[p])
        return;
    if (!mean->unseen[p])
        mean->unseen[p] = mem_alloc((mean->frame_count + 1) * sizeof(bool));
    for (size_t i = 0; i < mean->frame_count; i++) {
        double t = warp(mean, r, mean->times[i]);
        while (k + 1 < r->frame_count && fabs(r->times[k + 1] - t) <= fabs(r->times[k] - t))
            k++;
        mean->unseen[p][i] = mean->unseen[p][i] || r->unseen[p][k];
    }
}

static void average(const struct measured_speech *const *same, size_t count, struct measured_speech *out) {
    *out = (struct measured_speech){.repetitions = count};
    average_phones(same, count, out);
    out->frame_count = (size_t)(last_phone(out)->end * RECORDING_FPS) + 1;
    out->times = mem_alloc(out->frame_count * sizeof *out->times);
    for (size_t i = 0; i < out->frame_count; i++)
        out->times[i] = (double)i / RECORDING_FPS;
    for (int p = 0; p < PARAM_COUNT; p++) {
        size_t have = 0;
        for (size_t k = 0; k < count; k++)
            have += same[k]->curves[p] != NULL;
        if (have < count)
            continue;
        add_curves(out, same, count, p);
        for (size_t k = 0; k < count; k++)
            add_unseen(out, same[k], p);
    }
}

struct measured_speech *measured_speech_average_all(const struct measured_speech *list, size_t count,
                                                    size_t *out_count) {
    struct measured_speech *out = mem_alloc((count + 1) * sizeof *out);
    const struct measured_speech **same = mem_alloc((count + 1) * sizeof *same);
    bool *used = mem_alloc((count + 1) * sizeof *used);
    *out_count = 0;
    for (size_t i = 0; i < count; i++) {
        size_t n = 0;
        for (size_t k = i; k < count && (k == i ? !used[i] : n > 0); k++) {
            if (!used[k] && repeats(&list[i], &list[k])) {
                same[n++] = &list[k];
                used[k] = true;
            }
        }
        if (n)
            average(same, n, &out[(*out_count)++]);
    }
    free(used);
    free(same);
    return out;
}

/* Fine enough for any recording of up to an hour. */
enum { TICKS = 1000000 };

void measured_speech_segments(const struct speech_pack *pack, const struct measured_speech *r,
                              void (*warn)(void *ctx, const char *message), void *ctx,
                              struct phone_segments *out) {
    struct sentence_audio u = {.sample_rate = TICKS, .phone_count = r->phone_count};
    u.phones = mem_alloc((r->phone_count + 1) * sizeof *u.phones);
    for (size_t i = 0; i < r->phone_count; i++) {
        const struct recorded_phone *from = &r->phones[i];
        struct phone *to = &u.phones[i];
        snprintf(to->ipa, sizeof to->ipa, "%s", from->ipa);
        to->start = (uint32_t)lround(from->start * TICKS);
        to->end = u.samples = (uint32_t)lround(from->end * TICKS);
        to->stress = from->stress;
    }
    phone_segments_from(pack, &u, warn, ctx, out);
    free(u.phones);
}
