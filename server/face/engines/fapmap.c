/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/fapmap.h"
#include "server/base/mem.h"
#include "server/expression/expressions.h"
#include "server/expression/recipe.h"
#include "server/face/packs/shape_table.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Opening half-way to the corner relative to the middle: a parabola gives 3/4, but the lower lip is a
 * little fuller; a narrow mouth is round, so its sides close earlier. */
#define SIDE_OPENING 0.8
#define SIDE_PER_MM 0.03
#define SIDE_MIN 0.55

/* Secondary motion, mm per mm. */
#define CORNER_PER_JAW (-0.12) /* corners sink with the jaw */
#define CORNER_PER_SPREAD 0.12 /* and rise a little as they spread */
#define CHIN_PER_PRESS 0.5     /* the chin muscle lifts a pressing lower lip */
#define CHIN_PER_PUSH 0.2      /* and a protruding one */
#define CHEEK_PER_JAW (-0.06)  /* cheeks hollow as the jaw sinks */
#define CHEEK_PER_PUSH (-0.15) /* and as the lips protrude */
#define CHEEK_PER_PRESS 0.2    /* air is held behind closed lips */
#define LIFT_PER_SPREAD 0.12   /* spreading lifts the cheeks */
#define OUTER_PER_INNER 0.85   /* the outer contour moves less than the inner one */

/* Share of the jaw's movement that carries the tongue's tip and body, and how far they can sink into the
 * floor of the mouth, mm. */
#define TIP_PER_JAW 0.8
#define BODY_PER_JAW 0.5
#define TIP_FLOOR (-1.0)
#define BODY_FLOOR (-2.0)

/* Pressed lips become thin: approach of the outer contours, mm per mm of press. */
#define THIN_PER_PRESS 5.0

/* The lower lip's share in closing the lips. */
#define LOWER_SHARE 0.7

enum { MIDDLE, LEFT, RIGHT, PAIRS };

/* Opposite FAPs of the lips. Upper ones are positive downwards, lower ones upwards: they touch where the
 * sum is 0 and press where it is positive. */
static const struct {
    int upper, lower, upper_outer, lower_outer;
} pairs[PAIRS] = {{4, 5, 51, 52}, {8, 10, 55, 57}, {9, 11, 56, 58}};

static double positive(double x) {
    return x > 0 ? x : 0;
}

void fapmap_add(const struct speech_fapu *fapu, const double mm[PARAM_COUNT], double faps[FAP_COUNT + 1]) {
    double mns = 1024 / fapu->mns, mw = 1024 / fapu->mw, es = 1024 / fapu->es, ens = 1024 / fapu->ens;
    double spread = mm[PARAM_AR] / 2; /* per corner */
    double press = positive(-mm[PARAM_LI]), push = positive((mm[PARAM_PI] + mm[PARAM_PS]) / 2),
           jaw = positive(mm[PARAM_EM]);
    double corner = CORNER_PER_JAW * jaw + CORNER_PER_SPREAD * spread;
    double side = fmax(SIDE_MIN, SIDE_OPENING + SIDE_PER_MM * fmin(0, mm[PARAM_AR]));
    for (int i = 0; i < PAIRS; i++) {
        double part = i == MIDDLE ? 1 : side, at_corner = i == MIDDLE ? 0 : (1 - side) * corner;
        double up = (part * mm[PARAM_LS] + at_corner) * mns, down = (part * mm[PARAM_LI] - at_corner) * mns;
        faps[pairs[i].upper] -= up;
        faps[pairs[i].lower] -= down;
        /* Opening thins the lips; closing is handled by fapmap_part_lips. */
        faps[pairs[i].upper_outer] -= up > 0 ? OUTER_PER_INNER * up : up;
        faps[pairs[i].lower_outer] -= down > 0 ? OUTER_PER_INNER * down : down;
    }
    faps[3] += jaw * mns;
    faps[6] += spread * mw;
    faps[7] += spread * mw;
    faps[53] += spread * mw;
    faps[54] += spread * mw;
    faps[12] += corner * mns;
    faps[13] += corner * mns;
    faps[59] += corner * mns;
    faps[60] += corner * mns;
    faps[44] += fmax(mm[PARAM_TH] + TIP_PER_JAW * jaw, TIP_FLOOR) * mns;
    faps[45] += mm[PARAM_TA] * mw;
    faps[46] += fmax(mm[PARAM_TB] + BODY_PER_JAW * jaw, BODY_FLOOR) * mns;
    faps[16] += mm[PARAM_PI] * mns;
    faps[17] += mm[PARAM_PS] * mns;
    faps[18] += (CHIN_PER_PRESS * press + CHIN_PER_PUSH * push) * mns;
    double puff = CHEEK_PER_JAW * jaw + CHEEK_PER_PUSH * push + CHEEK_PER_PRESS * press;
    faps[39] += puff * es;
    faps[40] += puff * es;
    faps[41] += LIFT_PER_SPREAD * positive(spread) * ens;
    faps[42] += LIFT_PER_SPREAD * positive(spread) * ens;
}

void fapmap_open(const struct speech_fapu *fapu, double gap, double weight, double faps[FAP_COUNT + 1]) {
    double mns = 1024 / fapu->mns;
    for (int i = 0; i < PAIRS; i++) {
        double wanted = gap * mns * (i == MIDDLE ? 1 : SIDE_OPENING);
        double move = weight * positive(wanted + faps[pairs[i].upper] + faps[pairs[i].lower]);
        faps[pairs[i].lower] -= LOWER_SHARE * move;
        faps[pairs[i].lower_outer] -= LOWER_SHARE * move;
        faps[pairs[i].upper] -= (1 - LOWER_SHARE) * move;
        faps[pairs[i].upper_outer] -= (1 - LOWER_SHARE) * move;
    }
}

static void close_lips(const struct contact_demand *d, double mns, double faps[FAP_COUNT + 1]) {
    for (int i = 0; i < PAIRS; i++) {
        double missing = d->rule->press * mns - (faps[pairs[i].upper] + faps[pairs[i].lower]);
        double move = d->weight * positive(missing);
        double thin = d->weight * THIN_PER_PRESS * d->rule->press * mns;
        faps[pairs[i].lower] += LOWER_SHARE * move;
        faps[pairs[i].lower_outer] += LOWER_SHARE * (move + thin);
        faps[pairs[i].upper] += (1 - LOWER_SHARE) * move;
        faps[pairs[i].upper_outer] += (1 - LOWER_SHARE) * (move + thin);
    }
}

static void meet_teeth(const struct contact_demand *d, double mns, double faps[FAP_COUNT + 1]) {
    double side = SIDE_OPENING;
    for (int i = 0; i < PAIRS; i++) {
        double lowest = -d->rule->reach * mns * (i == MIDDLE ? 1 : side);
        double move = d->weight * positive(lowest - faps[pairs[i].lower]);
        faps[pairs[i].lower] += move;
        faps[pairs[i].lower_outer] += move;
    }
    faps[16] -= d->weight * positive(faps[16] + d->rule->retract * mns);
}

void fapmap_touch(const struct speech_fapu *fapu, const struct contact_demand demand[CONTACT_TEETH + 1],
                  double faps[FAP_COUNT + 1]) {
    double mns = 1024 / fapu->mns;
    if (demand[CONTACT_TEETH].weight > 0)
        meet_teeth(&demand[CONTACT_TEETH], mns, faps);
    if (demand[CONTACT_LIPS].weight > 0)
        close_lips(&demand[CONTACT_LIPS], mns, faps);
}

void fapmap_part_lips(const struct speech_fapu *fapu, double faps[FAP_COUNT + 1]) {
    double limit = FAPMAP_MAX_PRESS * 1024 / fapu->mns;
    for (int i = 0; i < PAIRS; i++) {
        double excess = positive(faps[pairs[i].upper] + faps[pairs[i].lower] - limit);
        faps[pairs[i].upper] -= excess / 2;
        faps[pairs[i].lower] -= excess / 2;
    }
}

void fapmap_read(const struct speech_fapu *fapu, const struct fap_frame *frame, double mm[PARAM_COUNT]) {
    double mns = fapu->mns / 1024, mw = fapu->mw / 1024;
    const int32_t *v = frame->value;
    double jaw = v[3] * mns;
    mm[PARAM_LS] = -v[4] * mns;
    mm[PARAM_LI] = -v[5] * mns;
    mm[PARAM_AR] = (v[6] + v[7]) * mw;
    mm[PARAM_PI] = v[16] * mns;
    mm[PARAM_PS] = v[17] * mns;
    mm[PARAM_EM] = jaw;
    mm[PARAM_TH] = v[44] * mns - TIP_PER_JAW * jaw;
    mm[PARAM_TA] = v[45] * mw;
    mm[PARAM_TB] = v[46] * mns - BODY_PER_JAW * jaw;
}

/* Transition into and out of a pause, s. */
#define PAUSE_EDGE 0.1

enum { BLEND_WHOLE = 63 }; /* blend: only select1 */

void visemes_from(const struct phone_segments *g, struct visemes *out) {
    out->keys = mem_alloc((g->count + 2) * sizeof *out->keys);
    out->count = 0;
    out->keys[out->count++] = (struct viseme_key){.begin = -1, .end = 0};
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        double middle = (item->start + item->end) / 2;
        struct viseme_key key = {.begin = middle, .end = middle, .from = item->start, .to = item->end};
        key.id = viseme_id_of(item->phone);
        if (item->phone) {
            key.viseme = item->phone->viseme;
            snprintf(key.ipa, sizeof key.ipa, "%s", item->phone->ipa);
        } else {
            key.begin = fmin(middle, item->start + PAUSE_EDGE);
            key.end = fmax(middle, item->end - PAUSE_EDGE);
        }
        out->keys[out->count++] = key;
    }
    out->keys[out->count++] = (struct viseme_key){.begin = g->end, .end = g->end + 1};
}

void visemes_free(struct visemes *visemes) {
    free(visemes->keys);
    *visemes = (struct visemes){0};
}

struct fap_viseme visemes_at(const struct visemes *visemes, double t, size_t *cursor) {
    const struct viseme_key *keys = visemes->keys;
    size_t i = *cursor;
    if (!visemes->count) /* nobody speaks */
        return (struct fap_viseme){.blend = BLEND_WHOLE};
    while (i > 0 && t < keys[i].begin)
        i--;
    while (i + 1 < visemes->count && t >= keys[i + 1].begin)
        i++;
    *cursor = i;
    struct fap_viseme out = {.select1 = keys[i].viseme, .select2 = keys[i].viseme, .blend = BLEND_WHOLE};
    if (i + 1 == visemes->count)
        return out;
    out.select2 = keys[i + 1].viseme;
    double x = (t - keys[i].end) / (keys[i + 1].begin - keys[i].end);
    if (x > 0)
        out.blend = (uint8_t)lround(BLEND_WHOLE * (1 - x * x * (3 - 2 * x)));
    return out;
}

double morph_weight(enum morph_ease ease, double t) {
    return ease == MORPH_SMOOTH ? t * t * (3 - 2 * t) : t;
}

void morph_add(struct morph *morph, double at, const double *faps) {
    if (morph->count && at <= morph->keys[morph->count - 1].at)
        return;
    morph->keys = mem_grow(morph->keys, &morph->cap, morph->count + 1, sizeof *morph->keys);
    morph->keys[morph->count++] = (struct morph_key){at, faps};
}

static size_t seek(const struct morph *morph, double t, size_t next) {
    if (next && morph->keys[next - 1].at > t)
        next = 0;
    /* Steps linearly first, then by bisection. */
    for (int step = 0; step < 4; step++) {
        if (next == morph->count || morph->keys[next].at > t)
            return next;
        next++;
    }
    size_t high = morph->count;
    while (next < high) {
        size_t mid = (next + high) / 2;
        if (morph->keys[mid].at > t)
            high = mid;
        else
            next = mid + 1;
    }
    return next;
}

/* cursor->at[0]: the first key later than the last instant */
static void add(const void *self, double t, struct speech_cursor *cursor, double faps[FAP_COUNT + 1]) {
    const struct morph *m = self;
    if (!m->count)
        return;
    size_t next = cursor->at[0] = seek(m, t, cursor->at[0]);
    const struct morph_key *to = &m->keys[next < m->count ? next : m->count - 1],
                           *from = next ? &m->keys[next - 1] : to;
    double weight = to == from ? 0 : morph_weight(m->ease, (t - from->at) / (to->at - from->at));
    for (int n = 3; n <= FAP_COUNT; n++)
        faps[n] += from->faps[n] + weight * (to->faps[n] - from->faps[n]);
}

static void morphing_free(void *self) {
    struct morph *m = self;
    free(m->keys);
    free(m);
}

struct speech_layer morph_layer(struct morph *morph) {
    struct morph *m = mem_alloc(sizeof *m);
    *m = *morph;
    *morph = (struct morph){0};
    return (struct speech_layer){add, morphing_free, m};
}

enum { VISEMES = 14, WHOLE = 63 };

struct face_high_level {
    double visemes[VISEMES + 1][FAP_COUNT + 1]; /* FAP units; 0 is the mouth at rest */
    double basics[BASIC_COUNT + 1][FAP_COUNT + 1];
};

/* One example phone for each viseme: p, f, th, t, k, sh, s, n, r, and the five vowels. */
static const char *const phones[VISEMES + 1] = {NULL, "p", "f", "θ", "t", "k", "ʃ", "s",
                                                "n",  "r", "a", "e", "i", "o", "u"};

struct face_high_level *face_high_level_new(const struct speech_pack *pack,
                                            const struct expressions *expressions) {
    struct face_high_level *high = mem_alloc(sizeof *high);
    for (size_t i = 1; i <= VISEMES; i++) {
        const struct speech_phone *phone =
            pack ? speech_pack_phone(pack, phones[i], strlen(phones[i])) : NULL;
        if (phone && phone->group)
            shape_of_phone(pack, phone, high->visemes[i]);
    }
    for (size_t i = 0; i < expressions_count(expressions); i++) {
        const struct expression *x = expressions_at(expressions, i);
        for (size_t k = 0; x->basic && k < x->pose.count; k++)
            high->basics[x->basic][x->pose.faps[k].fap] = x->pose.faps[k].value;
    }
    return high;
}

void face_high_level_free(struct face_high_level *high) {
    free(high);
}

static const double *chosen(const double (*table)[FAP_COUNT + 1], size_t last, uint8_t select) {
    return table[select <= last ? select : 0];
}

static double share(uint8_t part) {
    return (part < WHOLE ? part : WHOLE) / (double)WHOLE;
}

static void expand(const struct face_high_level *high, const bool *moved, struct fap_frame *frame) {
    const struct fap_viseme *v = &frame->viseme;
    const struct fap_expression *x = &frame->expression;
    double blend = share(v->blend);
    const double *viseme1 = chosen(high->visemes, VISEMES, v->select1),
                 *viseme2 = chosen(high->visemes, VISEMES, v->select2),
                 *basic1 = chosen(high->basics, BASIC_COUNT, x->select1),
                 *basic2 = chosen(high->basics, BASIC_COUNT, x->select2);
    bool visemes = fap_frame_has(frame, 1), basics = fap_frame_has(frame, 2);
    for (int n = 3; n <= FAP_COUNT; n++) {
        double value = visemes ? blend * viseme1[n] + (1 - blend) * viseme2[n] : 0;
        if (basics)
            value += share(x->intensity1) * basic1[n] + share(x->intensity2) * basic2[n];
        if (value != 0 && !moved[n])
            fap_frame_set(frame, n, fap_clamp(n, (int32_t)lround(value)));
    }
}

void face_high_level_expand(const struct face_high_level *high, struct fap_frame *frames, size_t count) {
    bool moved[FAP_COUNT + 1] = {0};
    if (!high)
        return;
    for (size_t i = 0; i < count; i++)
        for (int n = 3; n <= FAP_COUNT; n++)
            moved[n] |= fap_frame_has(&frames[i], n) && frames[i].value[n];
    for (size_t i = 0; i < count; i++)
        expand(high, moved, &frames[i]);
}
