/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prosody of a sentence: pitch by autocorrelation of about 40 ms at about 2.7 kHz, and accents. */
#include "server/face/life/life_prosody.h"
#include "server/base/mem.h"
#include "server/face/life/life_internal.h"
#include <math.h>
#include <stdlib.h>

enum { RATE = 2750, WINDOW = 64, LONGEST = 40, SHORTEST = 6 }; /* lags: 69 to 458 Hz */
#define VOICED 0.55

static int32_t product(const int16_t *a, const int16_t *b) {
    int32_t sum = 0;
    for (int i = 0; i < WINDOW; i++)
        sum += a[i] * b[i];
    return sum;
}

double prosody_pitch(const struct sentence_audio *u, uint32_t sample) {
    uint32_t step = u->sample_rate / RATE, size = (WINDOW + LONGEST) * step;
    if (!u->pcm || !step || u->samples < size)
        return 0;
    uint32_t from = sample > size / 2 ? sample - size / 2 : 0;
    if (from > u->samples - size)
        from = u->samples - size;
    int32_t sums[WINDOW + LONGEST], loudest = 1, mean = 0;
    for (uint32_t i = 0; i < WINDOW + LONGEST; i++) {
        const int16_t *pcm = u->pcm + from + i * step; /* averaging four suffices to remove most noise */
        sums[i] = pcm[0] + pcm[step / 4] + pcm[step / 2] + pcm[3 * step / 4];
        mean += sums[i] / (WINDOW + LONGEST);
    }
    for (int i = 0; i < WINDOW + LONGEST; i++) {
        sums[i] -= mean;
        loudest = abs(sums[i]) > loudest ? abs(sums[i]) : loudest;
    }
    /* eleven bits and the sign: the products of a window fit 32 bits */
    int16_t x[WINDOW + LONGEST];
    float scale = 2047.0f / (float)loudest;
    for (int i = 0; i < WINDOW + LONGEST; i++)
        x[i] = (int16_t)((float)sums[i] * scale);
    int32_t own = product(x, x), other = product(x + SHORTEST, x + SHORTEST);
    float best = 0, likeness[LONGEST + 1] = {0};
    for (int lag = SHORTEST; lag <= LONGEST; lag++) {
        int32_t common = product(x, x + lag);
        likeness[lag] = common > 0 ? (float)common / sqrtf((float)own * (float)other) : 0;
        best = fmaxf(best, likeness[lag]);
        if (lag < LONGEST)
            other += x[lag + WINDOW] * x[lag + WINDOW] - x[lag] * x[lag];
    }
    if (best < (float)VOICED)
        return 0;
    /* the first peak nearly as high as the maximum, to avoid octave errors */
    int lag = SHORTEST + 1;
    while (lag < LONGEST && (likeness[lag] < (float)0.88 * best || likeness[lag] < likeness[lag - 1] ||
                             likeness[lag] < likeness[lag + 1]))
        lag++;
    if (lag == LONGEST)
        return 0;
    float a = likeness[lag - 1], b = likeness[lag], c = likeness[lag + 1], bend = a - 2 * b + c;
    double shift = bend < 0 ? (double)((a - c) / (2 * bend)) : 0;
    return (double)u->sample_rate / step / (lag + shift);
}

/* Prominence of an average accent, and what increases it. */
#define WEIGHT 0.4
#define PER_LOUDNESS 0.5
#define PER_LENGTH 0.35
#define LAST_OF_PHRASE 0.2
#define SPREAD 0.8

/* semitones from the mean: larger deviations are pitch errors */
#define MISHEARD 9

#define NAME_SECONDS 8.0

enum { LOOKS = 32 }; /* samples used for an accent's loudness */

struct measure {
    double loudness, length;
    uint32_t sample;
};

void prosody_free(struct prosody *p) {
    free(p->phrases);
    free(p->accents);
    *p = (struct prosody){0};
}

static bool is_pause(const struct phone *p) {
    return !p->ipa[0];
}

static struct measure measure(const struct sentence_audio *u, const struct phone *p) {
    uint32_t size = p->end - p->start, sum = 0;
    for (uint32_t i = 0; u->pcm && i < LOOKS; i++)
        sum += (uint32_t)abs(u->pcm[p->start + (uint32_t)((uint64_t)size * (2 * i + LOOKS) / (4 * LOOKS))]);
    return (struct measure){(double)sum / LOOKS, (double)size / u->sample_rate, p->start + size / 2};
}

static void add_phone(struct prosody *p, const struct sentence_audio *u, const struct phone *phone,
                      struct measure **measures, size_t *cap) {
    double from = (double)phone->start / u->sample_rate, to = (double)phone->end / u->sample_rate;
    struct phrase *last = p->phrase_count ? &p->phrases[p->phrase_count - 1] : NULL;
    if (!last || from - last->to > PROSODY_PAUSE) {
        p->phrases = mem_grow(p->phrases, &p->phrase_cap, p->phrase_count + 1, sizeof *p->phrases);
        last = &p->phrases[p->phrase_count++];
        *last = (struct phrase){.from = from, .first = p->accent_count};
    }
    last->to = to;
    if (phone->stress < 2 || phone->end == phone->start)
        return;
    struct measure m = measure(u, phone);
    struct accent *before = last->count ? &p->accents[p->accent_count - 1] : NULL;
    if (before && before->at + (*measures)[p->accent_count - 1].length / 2 > from - 0.001) {
        /* adjacent stressed phones form one syllable with the longer one as nucleus */
        if (m.length <= (*measures)[p->accent_count - 1].length)
            return;
        p->accent_count--;
        last->count--;
    }
    p->accents = mem_grow(p->accents, &p->accent_cap, p->accent_count + 1, sizeof *p->accents);
    *measures = mem_grow(*measures, cap, p->accent_count + 1, sizeof **measures);
    (*measures)[p->accent_count] = m;
    p->accents[p->accent_count++] = (struct accent){.at = (from + to) / 2};
    last->count++;
}

/* Computes weights from the measures relative to their mean. */
static void weigh(struct prosody *p, const struct measure *measures) {
    double loudness = 0, length = 0;
    for (size_t i = 0; i < p->accent_count; i++) {
        loudness += measures[i].loudness / (double)p->accent_count;
        length += measures[i].length / (double)p->accent_count;
    }
    for (size_t i = 0; i < p->accent_count; i++) {
        double loud = loudness > 0 ? measures[i].loudness / loudness - 1 : 0;
        double weight = WEIGHT + PER_LOUDNESS * life_clip(loud, -SPREAD, SPREAD) +
                        PER_LENGTH * life_clip(measures[i].length / length - 1, -SPREAD, SPREAD);
        p->accents[i].weight = life_clip(weight, 0, 1);
    }
    for (size_t i = 0; i < p->phrase_count; i++)
        if (p->phrases[i].count) {
            struct accent *last = &p->accents[p->phrases[i].first + p->phrases[i].count - 1];
            last->weight = fmin(1, last->weight + LAST_OF_PHRASE);
        }
}

/* Selects the strongest accents, at least PROSODY_MAJOR_GAP apart, from left to right. */
static void choose_majors(struct prosody *p) {
    struct accent *last = NULL;
    for (size_t i = 0; i < p->accent_count; i++) {
        struct accent *a = &p->accents[i];
        a->major = !last || a->at - last->at >= PROSODY_MAJOR_GAP || a->weight > last->weight;
        if (a->major && last && a->at - last->at < PROSODY_MAJOR_GAP)
            last->major = false;
        if (a->major)
            last = a;
    }
}

static double semitones(double hz) {
    return 12 * log2(hz);
}

/* Computes the pitch of the major accents relative to their mean; outliers are ignored. */
static void listen(struct prosody *p, const struct sentence_audio *u, const struct measure *measures) {
    double sum = 0;
    size_t heard = 0;
    for (size_t i = 0; i < p->accent_count; i++) {
        bool strong = p->accents[i].major && p->accents[i].weight > WEIGHT;
        double hz = strong ? prosody_pitch(u, measures[i].sample) : 0;
        p->accents[i].pitch = hz > 0 ? semitones(hz) : 0;
        sum += p->accents[i].pitch;
        heard += hz > 0;
    }
    for (size_t i = 0; heard && i < p->accent_count; i++) {
        double above = p->accents[i].pitch - sum / (double)heard;
        p->accents[i].pitch = p->accents[i].pitch > 0 && fabs(above) < MISHEARD ? above : 0;
    }
}

/* Rise of the pitch in semitones within the last phone, or the one before if that is voiceless. */
static double rise(const struct sentence_audio *u) {
    for (size_t i = u->phone_count, tries = 0; i-- && tries < 2;) {
        const struct phone *p = &u->phones[i];
        if (is_pause(p))
            continue;
        tries++;
        double from = prosody_pitch(u, p->start + (p->end - p->start) / 4);
        double to = prosody_pitch(u, p->end - (p->end - p->start) / 8);
        if (from > 0 && to > 0)
            return semitones(to) - semitones(from);
    }
    return 0;
}

/* FNV-1a hash of the phones. */
static int64_t name_of(const struct sentence_audio *u, double begin) {
    uint64_t hash = 0xCBF29CE484222325u + (uint64_t)llround(begin / NAME_SECONDS);
    for (size_t i = 0; i < u->phone_count; i++)
        for (const char *c = u->phones[i].ipa; *c; c++)
            hash = (hash ^ (uint8_t)*c) * 0x100000001B3u;
    return (int64_t)(hash >> 8);
}

void prosody_of(const struct sentence_audio *u, double begin, struct prosody *p) {
    *p = (struct prosody){.name = name_of(u, begin), .end = (double)u->samples / u->sample_rate};
    struct measure *measures = NULL;
    size_t cap = 0;
    for (size_t i = 0; i < u->phone_count; i++)
        if (!is_pause(&u->phones[i]) && u->phones[i].end <= u->samples)
            add_phone(p, u, &u->phones[i], &measures, &cap);
    weigh(p, measures);
    choose_majors(p);
    if (u->pcm) {
        listen(p, u, measures);
        p->rise = rise(u);
    }
    free(measures);
}
