/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Louder, higher and faster than usual are what voices of high activation have in common (R. Banse and
 * K. Scherer, J. Personality and Social Psychology 70, 1996); whether it is joy or anger they do not tell. */
#include "server/face/life/heard_prosody.h"
#include "server/face/life/life_prosody.h"
#include "server/face/life/life_random.h"
#include <string.h>

/* dB: what lies so far below the loudest of late, or not so far above the quietest, is silence, and all below
 * that. The loudest is forgotten, the quietest rises by so much a step. */
#define BELOW_LOUDEST 25.0
#define ABOVE_FLOOR 10.0
#define SILENT (-55.0)
#define FORGET 0.03
#define FLOOR_RISE 0.01
#define FLOOR_FALL 0.1
#define SMOOTH 0.5 /* of the power, each step */

/* Steps: until he is taken to speak; syllables lie apart by at least, are over after, and what stands out
 * (PROSODY_MAJOR_GAP). */
enum { BEGIN_STEPS = 4, SYLLABLE_GAP = 10, PEAK_STEPS = 8, ACCENT_GAP = 75, LONG_GAP = 60 };
#define SYLLABLE_DIP 2.0 /* dB between two syllables */

/* Prominence, as of a text's accents, but that nobody knows the stressed ones. */
#define WEIGHT 0.4
#define PER_LOUDNESS 0.5
#define PER_SEMITONE 0.06
#define SPREAD 0.8
#define STANDS_OUT 0.55
#define MISHEARD 9.0

/* Syllables: of the means; before anything stands out; before anything is unusual. */
enum { FEW = 5, MANY = 40, KNOWN = 4, WELL_KNOWN = 12 };
#define UNUSUAL_LOUDNESS 6.0 /* dB */
#define UNUSUAL_PITCH 4.0    /* semitones */
#define UNUSUAL_TEMPO 0.4

static void take(struct running_mean *mean, double value, double over) {
    mean->count = fmin(mean->count + 1, over);
    mean->value += (value - mean->value) / mean->count;
}

void heard_prosody_begin(struct heard_prosody *p) {
    *p = (struct heard_prosody){.loudest = SILENT, .floor = SILENT, .since_accent = ACCENT_GAP};
}

static double loudness(struct heard_prosody *p, const float *samples) {
    double power = 0;
    memmove(p->pcm, p->pcm + PROSODY_STEP, sizeof p->pcm - PROSODY_STEP * sizeof *p->pcm);
    for (int i = 0; i < PROSODY_STEP; i++) {
        double x = life_clip((double)samples[i], -1, 1);
        power += x * x / PROSODY_STEP;
        p->pcm[PROSODY_WINDOW - PROSODY_STEP + i] = (int16_t)lrint(32767 * x);
    }
    p->power += SMOOTH * (power - p->power);
    double level = 10 * log10(p->power + 1e-10);
    p->loudest = fmax(level, fmax(SILENT, p->loudest - FORGET));
    p->floor = level < p->floor ? p->floor + FLOOR_FALL * (level - p->floor) : p->floor + FLOOR_RISE;
    return level;
}

static void phrases(struct heard_prosody *p, bool loud, struct heard_moment *m) {
    p->loud = loud ? p->loud + 1 : 0;
    p->quiet = loud ? 0 : p->quiet + 1;
    if (p->speaks) {
        p->phrase++;
        if (p->quiet < PROSODY_PAUSE_STEPS)
            return;
        *m = (struct heard_moment){.ends = true, .seconds = (p->phrase - PROSODY_PAUSE_STEPS) / 100.0};
        p->speaks = false;
        p->silence = PROSODY_PAUSE_STEPS;
        return;
    }
    if (p->silence < UINT32_MAX)
        p->silence++;
    if (p->loud < BEGIN_STEPS)
        return;
    *m = (struct heard_moment){.begins = true, .seconds = p->silence / 100.0};
    p->speaks = true;
    p->phrase = BEGIN_STEPS;
    p->rises = true;
    p->peak = p->dip = SILENT;
    p->pitch = 0;
    p->since_syllable = LONG_GAP;
}

static double pitch(const struct heard_prosody *p) {
    int16_t pcm[PROSODY_WINDOW];
    memcpy(pcm, p->pcm, sizeof pcm);
    const struct sentence_audio heard = {.sample_rate = PROSODY_RATE, .pcm = pcm, .samples = PROSODY_WINDOW};
    return prosody_pitch(&heard, PROSODY_WINDOW / 2);
}

/* A syllable is over. */
static void syllable(struct heard_prosody *p, struct heard_moment *m) {
    double height = 12 * log2(p->pitch), above = height - p->usual_pitch.value;
    double loud = pow(10, (p->peak - p->usual_loudness.value) / 20) - 1;
    if (p->syllables >= KNOWN && fabs(above) > MISHEARD)
        above = 0;
    m->semitones = above;
    m->weight =
        life_clip(WEIGHT + PER_LOUDNESS * life_clip(loud, -SPREAD, SPREAD) + PER_SEMITONE * above, 0, 1);
    m->stands_out =
        p->syllables >= KNOWN && m->weight >= STANDS_OUT && p->since_accent >= ACCENT_GAP && p->speaks;
    if (m->stands_out)
        p->since_accent = 0;
    if (p->since_syllable < LONG_GAP) {
        take(&p->usual_gap, p->since_syllable, MANY);
        take(&p->gap, p->since_syllable, FEW);
    }
    take(&p->usual_loudness, p->peak, MANY);
    take(&p->loudness, p->peak, FEW);
    take(&p->usual_pitch, p->usual_pitch.value + above, MANY);
    take(&p->height, p->usual_pitch.value + above, FEW);
    p->syllables++;
    p->since_syllable = 0;
}

static void follow(struct heard_prosody *p, double level, struct heard_moment *m) {
    p->since_peak++;
    p->since_syllable++;
    if (p->since_accent < ACCENT_GAP)
        p->since_accent++;
    if (!p->rises) {
        p->dip = fmin(p->dip, level);
        if (level < p->dip + SYLLABLE_DIP)
            return;
        p->rises = true;
        p->peak = SILENT;
        p->pitch = 0;
    }
    if (level > p->peak) {
        double hz = pitch(p);
        p->peak = level;
        p->pitch = hz > 0 ? hz : p->pitch;
        p->since_peak = 0;
    }
    if (level > p->peak - SYLLABLE_DIP && p->since_peak < PEAK_STEPS)
        return;
    if (p->pitch > 0 && p->peak > p->dip + SYLLABLE_DIP && p->since_syllable >= SYLLABLE_GAP)
        syllable(p, m);
    p->rises = false;
    p->dip = level;
}

struct heard_moment heard_prosody_step(struct heard_prosody *p, const float *samples) {
    struct heard_moment m = {0};
    double level = loudness(p, samples);
    double least = fmax(fmax(p->loudest - BELOW_LOUDEST, p->floor + ABOVE_FLOOR), SILENT);
    phrases(p, level > least, &m);
    if (p->speaks)
        follow(p, level, &m);
    return m;
}

double heard_prosody_arousal(const struct heard_prosody *p) {
    if (p->syllables < WELL_KNOWN || p->usual_gap.count < FEW)
        return 0;
    double loud = (p->loudness.value - p->usual_loudness.value) / UNUSUAL_LOUDNESS;
    double high = (p->height.value - p->usual_pitch.value) / UNUSUAL_PITCH;
    double fast = (p->usual_gap.value / p->gap.value - 1) / UNUSUAL_TEMPO;
    return life_clip((life_clip(loud, -1, 1) + life_clip(high, -1, 1) + life_clip(fast, -1, 1)) / 2, -1, 1);
}
