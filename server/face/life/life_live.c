/* SPDX-License-Identifier: GPL-3.0-or-later */
/* High activation makes voices louder, higher and faster (R. Banse and K. Scherer, J. Personality and
 * Social Psychology 70, 1996), whether joy or anger. */
#include "server/face/life/life_live.h"
#include "server/base/mem.h"
#include "server/face/life/life_internal.h"
#include "server/face/life/life_prosody.h"
#include <stdlib.h>
#include <string.h>

/* Prosody of a live voice from its sound so far: beginnings and pauses, prominent syllables, and
 * liveliness relative to earlier speech. Causal. */
enum {
    PROSODY_RATE = LIFE_LIVE_RATE,
    PROSODY_STEP = LIFE_LIVE_STEP,
    PROSODY_WINDOW = 640, /* window for pitch detection */
};

/* Running mean over a limited number of values, exact at the beginning. */
struct running_mean {
    double value, count;
};

struct live_prosody {
    int16_t pcm[PROSODY_WINDOW];
    double power, loudest, floor; /* of the sound; dB */
    bool speaks;
    unsigned loud, quiet, phrase,
        silence;             /* steps: loud or quiet in a row; since the voice began; silence before that */
    bool rises;              /* rising towards a syllable's peak */
    double peak, pitch, dip; /* dB, Hz, dB */
    unsigned since_peak, since_syllable, since_accent;
    unsigned syllables;
    struct running_mean usual_loudness, loudness, usual_pitch, height, usual_gap, gap;
};

/* Result of a step. */
struct live_moment {
    bool begins, ends; /* the voice begins; a phrase ended PROSODY_PAUSE_STEPS ago */
    double seconds;    /* of silence before it; of the phrase */
    bool stands_out;   /* a syllable did, about 30 to 80 ms ago */
    double weight;     /* how much, 0..1 */
    double semitones;  /* pitch above the usual one */
};

enum { PROSODY_PAUSE_STEPS = 25 };

/* dB: sound this far below the recent maximum, or less than this above the minimum, is silence, and
 * anything below the last limit. The maximum decays and the minimum rises by these amounts per step. */
#define BELOW_LOUDEST 25.0
#define ABOVE_FLOOR 10.0
#define SILENT (-55.0)
#define FORGET 0.03
#define FLOOR_RISE 0.01
#define FLOOR_FALL 0.1
#define SMOOTH 0.5 /* of the power, each step */

/* Steps: until a voice counts as speaking; minimum distance of syllables; until a syllable is over;
 * minimum distance of prominent ones (PROSODY_MAJOR_GAP). */
enum { BEGIN_STEPS = 4, SYLLABLE_GAP = 10, PEAK_STEPS = 8, ACCENT_GAP = 75, LONG_GAP = 60 };
#define SYLLABLE_DIP 2.0 /* dB between two syllables */

/* Prominence as for accents of a text, but without known stress. */
#define WEIGHT 0.4
#define PER_LOUDNESS 0.5
#define PER_SEMITONE 0.06
#define SPREAD 0.8
#define STANDS_OUT 0.55
#define MISHEARD 9.0

/* Numbers of syllables: for the means; before any is prominent; before any is unusual. */
enum { FEW = 5, MANY = 40, KNOWN = 4, WELL_KNOWN = 12 };
#define UNUSUAL_LOUDNESS 6.0 /* dB */
#define UNUSUAL_PITCH 4.0    /* semitones */
#define UNUSUAL_TEMPO 0.4

static void take(struct running_mean *mean, double value, double over) {
    mean->count = fmin(mean->count + 1, over);
    mean->value += (value - mean->value) / mean->count;
}

static void live_prosody_begin(struct live_prosody *p) {
    *p = (struct live_prosody){.loudest = SILENT, .floor = SILENT, .since_accent = ACCENT_GAP};
}

static double loudness(struct live_prosody *p, const float *samples) {
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

static void phrases(struct live_prosody *p, bool loud, struct live_moment *m) {
    p->loud = loud ? p->loud + 1 : 0;
    p->quiet = loud ? 0 : p->quiet + 1;
    if (p->speaks) {
        p->phrase++;
        if (p->quiet < PROSODY_PAUSE_STEPS)
            return;
        *m = (struct live_moment){.ends = true, .seconds = (p->phrase - PROSODY_PAUSE_STEPS) / 100.0};
        p->speaks = false;
        p->silence = PROSODY_PAUSE_STEPS;
        return;
    }
    if (p->silence < UINT32_MAX)
        p->silence++;
    if (p->loud < BEGIN_STEPS)
        return;
    *m = (struct live_moment){.begins = true, .seconds = p->silence / 100.0};
    p->speaks = true;
    p->phrase = BEGIN_STEPS;
    p->rises = true;
    p->peak = p->dip = SILENT;
    p->pitch = 0;
    p->since_syllable = LONG_GAP;
}

static double pitch(const struct live_prosody *p) {
    int16_t pcm[PROSODY_WINDOW];
    memcpy(pcm, p->pcm, sizeof pcm);
    const struct sentence_audio heard = {.sample_rate = PROSODY_RATE, .pcm = pcm, .samples = PROSODY_WINDOW};
    return prosody_pitch(&heard, PROSODY_WINDOW / 2);
}

/* Handles the end of a syllable. */
static void syllable(struct live_prosody *p, struct live_moment *m) {
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

static void follow(struct live_prosody *p, double level, struct live_moment *m) {
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

/* Takes the next PROSODY_STEP samples, -1..1. */
static struct live_moment live_prosody_step(struct live_prosody *p, const float *samples) {
    struct live_moment m = {0};
    double level = loudness(p, samples);
    double least = fmax(fmax(p->loudest - BELOW_LOUDEST, p->floor + ABOVE_FLOOR), SILENT);
    phrases(p, level > least, &m);
    if (p->speaks)
        follow(p, level, &m);
    return m;
}

/* Returns how much louder, higher and faster than usual the voice is, -1..1; 0 until enough was heard. */
static double live_prosody_arousal(const struct live_prosody *p) {
    if (p->syllables < WELL_KNOWN || p->usual_gap.count < FEW)
        return 0;
    double loud = (p->loudness.value - p->usual_loudness.value) / UNUSUAL_LOUDNESS;
    double high = (p->height.value - p->usual_pitch.value) / UNUSUAL_PITCH;
    double fast = (p->usual_gap.value / p->gap.value - 1) / UNUSUAL_TEMPO;
    return life_clip((life_clip(loud, -1, 1) + life_clip(high, -1, 1) + life_clip(fast, -1, 1)) / 2, -1, 1);
}

/* The rules of life_head.c and life_eyes.c as far as they do not need later speech: H. Graf et al. 2002
 * (nods, brows), A. Kendon 1967 (gaze at the ends of turns), A. Bentivoglio et al. 1997 (blinks). Events
 * detected late begin at once. */

/* Nods, degrees, s. */
#define NOD_LEAST 0.8
#define NOD_MOST 3.4
#define NOD_PER_SEMITONE 0.06
#define NOD_RISE 0.18
#define NOD_FALL 0.36
#define LAST_NOD 1.8
#define NODS_AFTER 0.8 /* minimum duration of a phrase, s */

/* Brow raises, FAP units: probability, and the height from which a raise is certain. */
#define BROW_CHANCE 0.7
#define BROW_LEAST 45
#define BROW_MOST 95
#define BROW_HOLD 0.08
#define HIGH 3.0

/* Silence before a new turn; duration and angles of the glance aside. */
#define TURN_SILENCE 1.0
#define ASIDE_CHANCE 0.6
#define ASIDE_LEAST 0.5
#define ASIDE_MOST 1.3
#define ASIDE_YAW 9.0
#define ASIDE_PITCH 5.0
#define HEAD_SHARE 0.3
/* Gaze at the listener, s: after a phrase, and into the next. */
#define LISTENER_AFTER 1.6
#define LISTENER_ON 0.3

#define BLINK_CHANCE 0.6
#define BLINK_GAP 1.2

/* For the liveliest voice, FAP units; rate per step; increase of nods. */
#define WIDE_BROWS 40
#define WIDE_LIDS 55
#define WAKE 0.02
#define NOD_MORE 0.4

enum { CURVES = 12, GLANCES = 4 };

struct look {
    double at, until, yaw, pitch; /* s; degrees, as the FAPs' */
};

struct life_live {
    struct live_prosody prosody;
    float *waiting;
    size_t count, cap;
    uint32_t steps;
    double shown; /* s, of the previous frame */
    struct dice dice;
    struct gesture_curve curves[CURVES];
    size_t curve_count;
    struct look looks[GLANCES];
    size_t look_count;
    double blink; /* its beginning */
    double arousal, eased;
};

struct life_live *life_live_new(void) {
    struct life_live *l = mem_alloc(sizeof *l);
    *l = (struct life_live){.blink = -BLINK_GAP, .dice = dice_of(0, DICE_GESTURES, 0)};
    live_prosody_begin(&l->prosody);
    return l;
}

void life_live_free(struct life_live *l) {
    if (l)
        free(l->waiting);
    free(l);
}

void life_live_write(struct life_live *l, const float *samples, size_t count) {
    l->waiting = mem_grow(l->waiting, &l->cap, l->count + count, sizeof *l->waiting);
    if (count)
        memcpy(l->waiting + l->count, samples, count * sizeof *samples);
    l->count += count;
}

/* Replaces the oldest gesture if all slots are in use. */
static struct gesture_curve *gesture(struct life_live *l, double at, double rise, double hold, double fall) {
    if (l->curve_count == CURVES)
        memmove(l->curves, l->curves + 1, --l->curve_count * sizeof *l->curves);
    struct gesture_curve *g = &l->curves[l->curve_count++];
    *g = (struct gesture_curve){fmax(at, l->shown), (float)rise, (float)hold, (float)fall, {0}};
    return g;
}

static void look(struct life_live *l, double at, double until, double yaw, double pitch) {
    if (l->look_count == GLANCES)
        memmove(l->looks, l->looks + 1, --l->look_count * sizeof *l->looks);
    at = fmax(at, l->shown);
    l->looks[l->look_count++] = (struct look){at, fmax(until, at), yaw, pitch};
}

static void nod(struct life_live *l, double at, double degrees) {
    double lively = 1 + NOD_MORE * l->eased;
    gesture(l, at, NOD_RISE, 0, NOD_FALL)->amount[GESTURE_PITCH] = (float)(degrees * lively);
}

/* Looks aside at the beginning of a turn. */
static void begin_turn(struct life_live *l, double at) {
    double roll = dice_roll(&l->dice), side = dice_roll(&l->dice) < 0.5 ? -1 : 1;
    double yaw = side * ASIDE_YAW * dice_between(&l->dice, 0.6, 1.2);
    double pitch = ASIDE_PITCH * dice_between(&l->dice, -1, 1);
    double length = dice_between(&l->dice, ASIDE_LEAST, ASIDE_MOST);
    if (roll > ASIDE_CHANCE)
        return;
    look(l, at, at + length, yaw, pitch);
    look(l, at + length, at + length + LISTENER_ON, 0, 0);
    struct gesture_curve *g = gesture(l, at, 0.45, fmax(0, length - 0.45), 0.5);
    g->amount[GESTURE_YAW] = (float)(HEAD_SHARE * yaw);
    g->amount[GESTURE_PITCH] = (float)(HEAD_SHARE * pitch);
}

static void begin_phrase(struct life_live *l, double at, double silence) {
    if (silence >= TURN_SILENCE)
        begin_turn(l, at);
    else
        look(l, at, at + LISTENER_ON, 0, 0);
}

static void end_phrase(struct life_live *l, double at, double length) {
    double roll = dice_roll(&l->dice);
    look(l, at, at + LISTENER_AFTER, 0, 0);
    if (length >= NODS_AFTER)
        nod(l, at, LAST_NOD * dice_between(&l->dice, 0.7, 1.2));
    if (roll < BLINK_CHANCE && fmax(at, l->shown) > l->blink + BLINK_GAP)
        l->blink = fmax(at, l->shown);
}

static void stress(struct life_live *l, double at, const struct live_moment *m) {
    double roll = dice_roll(&l->dice), amount = dice_between(&l->dice, BROW_LEAST, BROW_MOST);
    nod(l, at, (NOD_LEAST + (NOD_MOST - NOD_LEAST) * m->weight) * (1 + NOD_PER_SEMITONE * m->semitones));
    if (m->semitones < HIGH && roll > BROW_CHANCE * m->weight)
        return;
    struct gesture_curve *g = gesture(l, at, NOD_RISE, BROW_HOLD, NOD_FALL);
    g->amount[GESTURE_BROW_LEFT] = g->amount[GESTURE_BROW_RIGHT] = (float)amount;
}

void life_live_step(struct life_live *l) {
    float samples[PROSODY_STEP] = {0};
    size_t count = l->count < PROSODY_STEP ? l->count : PROSODY_STEP;
    if (count) {
        memcpy(samples, l->waiting, count * sizeof *samples);
        l->count -= count;
        memmove(l->waiting, l->waiting + count, l->count * sizeof *samples);
    }
    struct live_moment m = live_prosody_step(&l->prosody, samples);
    double now = ++l->steps * (double)PROSODY_STEP / PROSODY_RATE;
    if (m.begins)
        begin_phrase(l, now - 0.05, l->steps > 100 ? m.seconds : TURN_SILENCE);
    if (m.ends)
        end_phrase(l, now, m.seconds);
    if (m.stands_out)
        stress(l, now - 0.08, &m);
    /* filtered twice, so that it starts and ends smoothly */
    double goal = l->prosody.speaks ? live_prosody_arousal(&l->prosody) : 0;
    l->arousal += WAKE * (goal - l->arousal);
    l->eased += WAKE * (l->arousal - l->eased);
}

static void gestures_at(struct life_live *l, double t, double out[GESTURE_CHANNELS]) {
    size_t kept = 0;
    for (size_t i = 0; i < l->curve_count; i++) {
        const struct gesture_curve g = l->curves[i];
        if (t - g.at > (double)g.rise + (double)g.hold + (double)g.fall)
            continue;
        double part = gesture_curve_at(&g, t);
        for (int c = 0; c < GESTURE_CHANNELS; c++)
            out[c] += part * (double)g.amount[c];
        l->curves[kept++] = g;
    }
    l->curve_count = kept;
}

/* Returns the current glance, or NULL if the eyes are free. */
static const struct look *look_at(const struct life_live *l, double t) {
    const struct look *found = NULL;
    for (size_t i = 0; i < l->look_count; i++)
        if (l->looks[i].at <= t)
            found = &l->looks[i];
    return found && t < found->until ? found : NULL;
}

static double lids_at(const struct life_live *l, double t) {
    double since = t - l->blink;
    return since < BLINK_CLOSING ? life_smooth(since / BLINK_CLOSING)
                                 : 1 - life_smooth((since - BLINK_CLOSING - BLINK_CLOSED) / BLINK_OPENING);
}

static void add(struct fap_frame *frame, int n, double value) {
    fap_frame_set(frame, n, fap_clamp(n, frame->value[n] + (int32_t)lrint(value)));
}

void life_live_add(struct life_live *l, double t, struct fap_frame *frame) {
    static const struct look nowhere = {0};
    double g[GESTURE_CHANNELS] = {0}, shut = lids_at(l, t), wide = l->eased;
    const struct look *own = look_at(l, t), *where = own ? own : &nowhere;
    gestures_at(l, t, g);
    for (int side = 0; side < 2; side++) {
        double brow = g[GESTURE_BROW_LEFT + side] + WIDE_BROWS * fmax(0, wide);
        double eye = where->pitch - g[GESTURE_PITCH];
        add(frame, 19 + side, shut * LID_UPPER + (1 - shut) * (LID_UPPER_FOLLOWS * eye - WIDE_LIDS * wide));
        add(frame, 21 + side, shut * LID_LOWER);
        add(frame, 23 + side, DEGREE * (where->yaw - g[GESTURE_YAW]));
        add(frame, 25 + side, DEGREE * eye);
        add(frame, 31 + side, 0.8 * brow);
        add(frame, 33 + side, brow);
        add(frame, 35 + side, 0.9 * brow);
    }
    add(frame, 48, DEGREE * g[GESTURE_PITCH]);
    add(frame, 49, DEGREE * g[GESTURE_YAW]);
    for (int n = 23; n <= 26 && !own; n++)
        frame->mask[(n - 1) / 8] &= (uint8_t) ~(1u << ((n - 1) % 8));
    l->shown = t;
}
