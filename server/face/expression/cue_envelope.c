/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/expression/cue_envelope.h"
#include "server/base/mem.h"
#include "server/base/smoothstep.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* E. Akagunduz 2004, eq. 5.4: expressions cross-fade while one letter changes into the next. A pause
 * counts for this many seconds of the transition. */
#define PAUSE_REACH 0.15
/* Default weight of an emotion in that rule (the same, chapter 5.2). */
#define WEIGHT_DEFAULT 0.2

static double clamp(double x, double min, double max) {
    return fmax(min, fmin(max, x));
}

/* Returns the middles of the phones around an instant, which bound the letter transition. */
static void transition(const struct sentence_audio *u, double at, double *from, double *to) {
    double rate = u->sample_rate;
    *from = at - CUE_FASTEST / 2;
    *to = at + CUE_FASTEST / 2;
    for (size_t i = 0; i < u->phone_count; i++) {
        double start = u->phones[i].start / rate, end = u->phones[i].end / rate, half = (end - start) / 2;
        if (!u->phones[i].ipa[0])
            half = fmin(half, PAUSE_REACH);
        if (end <= at + 1e-6)
            *from = fmin(end - half, at - CUE_FASTEST / 2);
        else if (start >= at - 1e-6) {
            *to = fmax(start + half, at + CUE_FASTEST / 2);
            return;
        }
    }
}

/* Fits rise and fall into the available time. */
static void squeeze(struct cue_envelope *s) {
    double rise = s->full - s->begin, fall = s->end - s->fall, room = s->end - s->begin;
    if (rise + fall <= room)
        return;
    double part = room / (rise + fall);
    s->full = s->begin + fmax(CUE_FASTEST, rise * part);
    s->fall = s->end - fmax(CUE_FASTEST, fall * part);
}

static void time_pose(const struct cue *cue, const struct sentence_audio *u, double end,
                      struct cue_envelope *s) {
    const struct envelope *curve = &s->expression->curve;
    bool early = cue->onset < 0 && cue->delay <= 0; /* faces move before the voice */
    double rise = fmax(CUE_FASTEST, cue->onset >= 0 ? cue->onset : curve->attack);
    double fall = fmax(CUE_FASTEST, cue->offset >= 0 ? cue->offset : curve->decay);
    s->begin = fmax(0, s->from - (early ? rise / 2 : 0));
    s->full = s->begin + rise;
    s->end = s->to + (cue->offset >= 0 ? 0 : fall);
    s->fall = s->end - fall;
    if (s->straight && early)
        transition(u, s->from, &s->begin, &s->full);
    if (s->straight && cue->offset < 0)
        transition(u, s->to, &s->fall, &s->end);
    if (s->begin < 0) { /* speech from the first sample */
        s->full -= s->begin;
        s->begin = 0;
    }
    if (s->end > end) {
        s->fall -= s->end - end;
        s->end = end;
    }
    if (cue->began_before) {
        s->begin = s->full = -INFINITY;
    } else if (cue->goes_on) {
        s->full = fmin(s->full, end);
        s->begin = fmax(0, fmin(s->begin, s->full - CUE_FASTEST));
    }
    if (cue->goes_on)
        s->fall = s->end = INFINITY;
    else if (!cue->began_before)
        squeeze(s);
    else {
        s->end = fmax(s->end, CUE_FASTEST);
        s->fall = clamp(s->fall, 0, s->end - CUE_FASTEST);
    }
}

static void time_settling(const struct cue *cue, double end, struct cue_envelope *s) {
    const struct envelope *curve = &s->expression->curve;
    s->settle_from = s->full + curve->hold;
    s->settle_to = s->settle_from + curve->settle;
    if (cue->began_before) {
        s->settle_from = s->settle_to = -INFINITY;
    } else if (cue->goes_on && s->settle_to > end) {
        s->settle_to = end;
        s->settle_from = clamp(end - curve->settle, 0, s->settle_from);
    }
}

static void time_gesture(const struct cue *cue, double end, struct cue_envelope *s) {
    const struct expression *x = s->expression;
    bool at_end = x->anchor == ANCHOR_END;
    s->reach = 0;
    if (!x->key_count || (at_end ? cue->goes_on : cue->began_before) || end <= 0)
        return;
    double begin = x->keys[0].at, length = x->keys[x->key_count - 1].at - begin;
    s->pace = fmin(1, end / length);
    /* hurried gestures are also smaller */
    s->reach = fmin(1, 2 * s->pace) * s->intensity;
    double start = clamp((at_end ? s->to : s->from) + begin, 0, end - length * s->pace);
    s->gesture = start - begin * s->pace;
    s->first = fmin(s->first, start);
    s->last = fmax(s->last, start + length * s->pace);
}

static bool place(const struct cue *cue, const struct sentence_audio *u, const struct expression *x,
                  enum face_blend blend, struct cue_envelope *s) {
    double rate = u->sample_rate, end = u->samples / rate;
    bool is_affect = !strcmp(x->kind, "affect");
    *s = (struct cue_envelope){.expression = x, .intensity = clamp(cue->intensity, 0, 1)};
    s->weight = clamp(cue->weight >= 0 ? cue->weight : WEIGHT_DEFAULT, 0, 1);
    s->is_affect = is_affect;
    s->straight = is_affect && blend == BLEND_WEIGHTED;
    s->from = fmax(0, cue->start / rate + cue->delay);
    s->to = fmax(s->from, s->from + cue->duration);
    if (!(s->intensity > 0) || !(s->from <= end) || !isfinite(s->to))
        return false;
    time_pose(cue, u, end, s);
    time_settling(cue, end, s);
    s->first = s->begin;
    s->last = s->end;
    time_gesture(cue, end, s);
    return true;
}

static int by_first(const void *a, const void *b) {
    const struct cue_envelope *x = a, *y = b;
    if (x->first != y->first)
        return x->first < y->first ? -1 : 1;
    if (x->to != y->to)
        return x->to > y->to ? -1 : 1; /* outer ones first */
    return (x->order > y->order) - (x->order < y->order);
}

static void find_latest(struct cue_envelopes *shows) {
    for (size_t i = 0; i < shows->count; i++)
        shows->latest[i] = i ? fmax(shows->latest[i - 1], shows->items[i].last) : shows->items[i].last;
}

void cue_envelopes_from(const struct sentence_audio *u, const struct expressions *expressions,
                        enum face_blend blend, struct cue_envelopes *out) {
    *out = (struct cue_envelopes){0};
    if (!u->cue_count || !u->sample_rate)
        return;
    out->items = mem_alloc(u->cue_count * sizeof *out->items);
    out->latest = mem_alloc(u->cue_count * sizeof *out->latest);
    for (size_t i = 0; i < u->cue_count; i++) {
        int found = expressions_find(expressions, u->cues[i].kind, u->cues[i].name);
        struct cue_envelope *show = &out->items[out->count];
        if (found < 0 || !place(&u->cues[i], u, expressions_at(expressions, (size_t)found), blend, show))
            continue;
        show->order = i;
        out->count++;
    }
    qsort(out->items, out->count, sizeof *out->items, by_first);
    find_latest(out);
}

void cue_envelopes_calm(struct cue_envelopes *shows) {
    size_t kept = 0;
    for (size_t i = 0; i < shows->count; i++)
        if (shows->items[i].is_affect) {
            shows->items[kept] = shows->items[i];
            shows->items[kept++].reach = 0;
        }
    shows->count = kept;
    find_latest(shows);
}

void cue_envelopes_free(struct cue_envelopes *shows) {
    free(shows->items);
    free(shows->latest);
    *shows = (struct cue_envelopes){0};
}

double cue_envelope_level(const struct cue_envelope *s, double t) {
    if (t <= s->begin || t >= s->end)
        return 0;
    if (t >= s->full && t <= s->fall && (s->straight || t <= s->settle_from))
        return 1;
    double rise = t >= s->full ? 1 : (t - s->begin) / (s->full - s->begin);
    double fall = t <= s->fall ? 1 : (s->end - t) / (s->end - s->fall);
    if (s->straight)
        return rise * fall;
    double settled = t <= s->settle_from ? 0
                     : t >= s->settle_to ? 1
                                         : smoothstep((t - s->settle_from) / (s->settle_to - s->settle_from));
    return smoothstep(rise) * smoothstep(fall) * (1 - (1 - s->expression->curve.sustain) * settled);
}

bool cue_envelope_gesture(const struct cue_envelope *s, double t, size_t *key, double *on) {
    const struct expression *x = s->expression;
    if (!(s->reach > 0))
        return false;
    double at = (t - s->gesture) / s->pace;
    if (at <= x->keys[0].at || at >= x->keys[x->key_count - 1].at)
        return false;
    size_t k = 0;
    while (at >= x->keys[k + 1].at)
        k++;
    *key = k;
    *on = (at - x->keys[k].at) / (x->keys[k + 1].at - x->keys[k].at);
    if (!x->is_sampled)
        *on = smoothstep(*on);
    return true;
}

/* Empowering constant of eq. 5.2. Weights above 1/3 would exaggerate the expression and are clipped there. */
#define RHO 3
#define SHOWN_MAX 1.25

/* Limits of the change of articulation. */
#define ARTICULATION_MIN 0.75
#define ARTICULATION_MAX 1.3

/* Regions: limits of an expression during speech, FAP units: lips and jaw (1.5 mm of the modelled
 * speaker), corners vertically, and sideways. */
#define LIPS_MAX 75
#define CORNER_HEIGHT_MAX 190
#define CORNER_WIDTH_MAX 80
/* Rounded lips are not pulled apart: share of an expression's width that is removed, in full when the
 * corners have come in by ROUND. */
#define ROUND_SHARE 0.8
#define ROUND 100

#define INTENSITY_MAX 63 /* of FAP 2 */

enum part { PART_FREE, PART_LIPS, PART_CORNERS, PART_TONGUE };

static const uint8_t lips[] = {3, 4, 5, 8, 9, 10, 11, 14, 15, 16, 17, 18, 51, 52, 55, 56, 57, 58},
                     heights[] = {12, 13, 59, 60}, widths[] = {6, 7, 53, 54}, tongue[] = {43, 44, 45, 46, 47};

/* clang-format off */
static const uint8_t part_of[FAP_COUNT + 1] = {
    [3] = PART_LIPS, PART_LIPS, PART_LIPS, PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [12] = PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [43] = PART_TONGUE, PART_TONGUE, PART_TONGUE, PART_TONGUE, PART_TONGUE,
    [51] = PART_LIPS, PART_LIPS, PART_CORNERS, PART_CORNERS, PART_LIPS, PART_LIPS, PART_LIPS, PART_LIPS,
    [59] = PART_CORNERS, PART_CORNERS,
};
/* clang-format on */

/* Adds w times the pose: the mouth's part to b->mouth, scaled by part, the rest to the face. */
static void add(struct blend *b, const struct pose *pose, double w, const double shares[]) {
    for (size_t i = 0; i < pose->count; i++) {
        const struct pose_fap *p = &pose->faps[i];
        enum part part = part_of[p->fap];
        if (part)
            b->mouth[p->fap] += w * shares[part] * p->value;
        else
            b->face[p->fap] += w * p->value;
    }
}

void blend_add(struct blend *b, const struct pose *pose, double w, struct mouth_share mouth) {
    const double shares[] = {[PART_LIPS] = 1 - b->activity * (1 - mouth.lips),
                             [PART_CORNERS] = 1 - b->activity * (1 - mouth.corners),
                             [PART_TONGUE] = 1 - b->activity};
    add(b, pose, w, shares);
}

double blend_shown(double omega) {
    return fmin(RHO * omega, SHOWN_MAX);
}

void blend_add_weighted(struct blend *b, const struct pose *pose, double omega) {
    static const double whole[] = {1, 1, 1, 1};
    add(b, pose, blend_shown(omega), whole);
}

static double limit(double value, double max) {
    return value > max ? max : value < -max ? -max : value;
}

/* (1 - omega) speech. The published rule lets lips open in closures; here closures win. */
static void weaken(const struct blend *b, double omega) {
    double lips_left = 1 - omega * (1 - b->contact);
    for (int n = 3; n <= FAP_COUNT; n++)
        b->face[n] *= part_of[n] == PART_LIPS || part_of[n] == PART_TONGUE ? lips_left : 1 - omega;
}

void blend_speech(const struct blend *b, double articulation, double omega) {
    articulation = articulation < ARTICULATION_MIN ? ARTICULATION_MIN : limit(articulation, ARTICULATION_MAX);
    if (articulation != 1)
        for (int n = 3; n <= FAP_COUNT; n++)
            if (part_of[n] != PART_TONGUE)
                b->face[n] *= articulation;
    if (omega > 0)
        weaken(b, limit(omega, 1));
}

/* Adds FAPs of the mouth, limited to max during speech and unlimited in pauses. */
static void join(const struct blend *b, const uint8_t *faps, size_t count, double max, double share) {
    for (size_t i = 0; i < count; i++) {
        double value = b->mouth[faps[i]];
        b->face[faps[i]] += share * (value + b->activity * (limit(value, max) - value));
    }
}

void blend_join(const struct blend *b) {
    /* contacts exclude expressions from the mouth */
    double free = 1 - b->contact, width = 1;
    bool bounded = b->rule == BLEND_REGIONS;
    if (bounded && b->mouth[6] + b->mouth[7] > 0)
        width = 1 - ROUND_SHARE * smoothstep(-(b->face[6] + b->face[7]) / (2 * ROUND));
    join(b, lips, sizeof lips, bounded ? LIPS_MAX : INFINITY, free);
    join(b, heights, sizeof heights, bounded ? CORNER_HEIGHT_MAX : INFINITY, 1);
    join(b, widths, sizeof widths, bounded ? CORNER_WIDTH_MAX : INFINITY, width);
    join(b, tongue, sizeof tongue, INFINITY, free);
}

struct fap_expression blend_basics(const double shares[BASIC_COUNT + 1]) {
    int first = 0, second = 0;
    for (int b = 1; b <= BASIC_COUNT; b++) {
        if (shares[b] > (first ? shares[first] : 0)) {
            second = first;
            first = b;
        } else if (shares[b] > (second ? shares[second] : 0)) {
            second = b;
        }
    }
    struct fap_expression out = {0};
    if (first)
        out.intensity1 = (uint8_t)lround(INTENSITY_MAX * fmin(1, shares[first]));
    if (second)
        out.intensity2 = (uint8_t)lround(INTENSITY_MAX * fmin(1, shares[second]));
    out.select1 = out.intensity1 ? (uint8_t)first : 0;
    out.select2 = out.intensity2 ? (uint8_t)second : 0;
    return out;
}
