/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/recording/recording_voice_internal.h"
#include <math.h>
#include <sonic.h>
#include <stdlib.h>
#include <string.h>

enum {
    PIECE = 4096, /* samples passed at a time */
    PASSES = 3,
};
#define CLOSE 0.0005 /* relative tolerance: half a millisecond per second */

void tempo_add(struct tempo *t, uint32_t from, double speed) {
    struct tempo_change *last = t->count ? &t->changes[t->count - 1] : NULL;
    if (last ? last->speed == speed : speed == 1)
        return;
    if (last && last->from == from) {
        last->speed = speed;
        return;
    }
    t->changes = mem_grow(t->changes, &t->cap, t->count + 2, sizeof *t->changes);
    if (!t->count && from)
        t->changes[t->count++] = (struct tempo_change){0, 1};
    t->changes[t->count++] = (struct tempo_change){from, speed};
}

void tempo_free(struct tempo *t) {
    free(t->changes);
    *t = (struct tempo){0};
}

static double ideal(const struct tempo *t, double sample) {
    double at = 0;
    for (size_t i = 0; i < t->count && t->changes[i].from < sample; i++) {
        double end = i + 1 < t->count ? fmin(sample, t->changes[i + 1].from) : sample;
        at += (end - t->changes[i].from) / t->changes[i].speed;
    }
    return at;
}

uint32_t tempo_at(const struct tempo *t, const struct sentence_audio *u, uint64_t sample) {
    double at = t->scale > 0 ? round(t->scale * ideal(t, (double)sample)) : (double)sample;
    return at < u->samples ? (uint32_t)at : u->samples;
}

/* Collects finished samples. */
static void collect(sonicStream stream, struct sentence_audio *out, size_t *cap) {
    int ready = sonicSamplesAvailable(stream);
    out->pcm = mem_grow(out->pcm, cap, out->samples + (size_t)ready + 1, sizeof *out->pcm);
    out->samples += (uint32_t)sonicReadShortFromStream(stream, out->pcm + out->samples, ready);
}

/* Stretches all samples, with the changed parts at `off` times their speed. Returns false when out of
 * memory. */
static bool stretch(const struct tempo *t, double off, const struct sentence_audio *u,
                    struct sentence_audio *out, size_t *cap) {
    sonicStream stream = sonicCreateStream((int)u->sample_rate, 1);
    size_t change = 0;
    out->samples = 0;
    if (!stream)
        return false;
    for (uint32_t at = 0, count; at < u->samples; at += count) {
        if (change < t->count && t->changes[change].from <= at) {
            double speed = t->changes[change++].speed;
            sonicSetSpeed(stream, (float)(speed == 1 ? 1 : speed * off));
        }
        uint32_t end =
            change < t->count && t->changes[change].from < u->samples ? t->changes[change].from : u->samples;
        count = end - at < PIECE ? end - at : PIECE;
        sonicWriteShortToStream(stream, u->pcm + at, (int)count);
        collect(stream, out, cap);
    }
    sonicFlushStream(stream);
    collect(stream, out, cap);
    sonicDestroyStream(stream);
    return true;
}

/* Number of samples with unchanged speed. */
static double unchanged(const struct tempo *t, uint32_t samples) {
    double sum = 0;
    for (size_t i = 0; i < t->count; i++)
        if (t->changes[i].speed == 1)
            sum += fmin(i + 1 < t->count ? t->changes[i + 1].from : samples, samples) -
                   fmin(t->changes[i].from, samples);
    return sum;
}

/* Rounding to whole periods makes it up to one per cent too long or too short, so a second pass corrects
 * it. */
void tempo_apply(struct tempo *t, struct sentence_audio *u) {
    struct sentence_audio out = {0};
    size_t cap = 0;
    double wanted = ideal(t, u->samples), same = unchanged(t, u->samples), off = 1;
    bool done = wanted - same >= 1;
    for (int i = 0; i < PASSES && done && (!i || fabs(out.samples / wanted - 1) > CLOSE); i++) {
        off *= i ? fmin(fmax((out.samples - same) / (wanted - same), 0.9), 1.1) : 1;
        done = stretch(t, off, u, &out, &cap);
    }
    if (!done) {
        free(out.pcm);
        return;
    }
    t->scale = out.samples / wanted;
    free(u->pcm);
    u->pcm = out.pcm;
    u->samples = out.samples;
    for (size_t i = 0; i < u->phone_count; i++) {
        u->phones[i].start = tempo_at(t, u, u->phones[i].start);
        u->phones[i].end = tempo_at(t, u, u->phones[i].end);
    }
    for (size_t i = 0; i < u->word_count; i++) {
        u->words[i].start = tempo_at(t, u, u->words[i].start);
        u->words[i].end = tempo_at(t, u, u->words[i].end);
    }
}
