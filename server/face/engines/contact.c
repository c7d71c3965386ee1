/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/contact.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <stdlib.h>

/* Share of the way out of a contact that only takes off its press: lips that open by up to 16 mm still touch
 * then. It lies before the contact's end, so that they part at the burst and not after it. */
#define UNPRESSING 0.07
/* Share of a vowel that a stretched contact may take, as long as there is time on its other side. */
#define VOWEL_GIVES 0.25
#define MAX_RAMP 0.07
#define MIN_RAMP 0.01

/* Time left to a vowel between two contacts that can give way, s: one frame at 25 fps, plus the lips'
 * transitions. */
#define VOWEL_ROOM 0.055
/* The part of it without transitions. */
#define VOWEL_OPEN 0.025

/* Iterations of moving contacts apart to make room for the vowels between them. */
enum { ROUNDS = 4 };

/* A contact with its length fixed but not its position. */
struct draft {
    const struct contact_rule *rule;
    size_t first, last; /* range of segments */
    double begin, end;  /* s: without stretching */
    double extra;       /* s: additional length */
    double before;      /* s: part of `extra` before begin */
    double least, most; /* bounds of `before` */
};

struct drafts {
    const struct phone_segments *g;
    struct draft *items;
    size_t count, cap;
};

static enum contact_kind kind_of(const struct phone_segment *g) {
    return g->phone ? g->phone->contact.kind : CONTACT_NONE;
}

static bool is_vowel(const struct phone_segment *g) {
    return g->phone && g->phone->group->vowel;
}

static const struct phone_segment *beside(const struct phone_segments *g, size_t i, bool before) {
    return before ? (i ? &g->items[i - 1] : NULL) : i + 1 < g->count ? &g->items[i + 1] : NULL;
}

/* Returns how far a contact may reach on one side: a part of the neighbour, or none of it if that has a
 * contact itself. A pause at the sentence's edge may be used completely. */
static double limit(const struct phone_segments *g, size_t i, bool before, double part) {
    const struct phone_segment *n = beside(g, i, before);
    if (!n)
        return before ? g->items[i].start - MAX_RAMP : g->items[i].end + MAX_RAMP;
    double length = n->end - n->start, reach = part * length;
    if (kind_of(n))
        reach = 0;
    else if (!n->phone)
        reach = fmin(MAX_RAMP, (before ? i == 1 : i + 2 == g->count) ? length : length / 2);
    return before ? n->end - reach : n->start + reach;
}

static double gives(const struct phone_segments *g, size_t i, bool before) {
    const struct phone_segment *n = beside(g, i, before);
    return limit(g, i, before, n && is_vowel(n) ? VOWEL_GIVES : 0.5);
}

static double clamp(double x, double least, double most) {
    return fmax(least, fmin(most, x));
}

static double begin_of(const struct draft *d) {
    return d->begin - d->before;
}

static double end_of(const struct draft *d) {
    return d->end + d->extra - d->before;
}

/* Stretches a contact that is too short into its neighbours: into the one before it, because viewers tolerate
 * early lips better than lips that are still closed after the burst, and only where that has no room also
 * into the one behind it. If they are too short to give half each, it still takes half of
 * CONTACT_MIN_SECONDS from them. It ends with its sound, so that the frame that shows it is displayed while
 * it is heard, and stays within the audio. */
static void stretch(const struct phone_segments *g, struct draft *d) {
    d->extra = fmax(0, CONTACT_MIN_SECONDS - (d->end - d->begin));
    double half = CONTACT_MIN_SECONDS / 2, left = fmax(half, d->begin - gives(g, d->first, true)),
           right = fmax(half, gives(g, d->last, false) - d->end);
    const struct phone_segment *previous = beside(g, d->first, true), *next = beside(g, d->last, false);
    d->most = fmin(d->extra, previous && kind_of(previous) ? left : d->begin);
    d->least = fmax(0, d->extra - (next && kind_of(next) ? right : g->end - d->end));
    d->least = fmax(d->least, fmin(d->most, d->extra - (g->items[d->last].end - d->end)));
    d->most = fmax(d->least, d->most);
    d->before = clamp(fmin(left, d->extra), d->least, d->most);
}

/* Returns the nearest vowel on one side of contact k, or NULL if another contact lies between. */
static const struct phone_segment *vowel_beside(const struct drafts *all, size_t k, bool before) {
    const struct phone_segment *n;
    for (size_t i = before ? all->items[k].first : all->items[k].last;
         (n = beside(all->g, i, before)) && !kind_of(n); i = before ? i - 1 : i + 1)
        if (is_vowel(n))
            return n;
    return NULL;
}

/* Returns where the available time of the vowel beside contact k ends. */
static double room_edge(const struct drafts *all, size_t k, const struct phone_segment *vowel, bool before) {
    if (before)
        return fmax(vowel->start - MIN_RAMP, k ? end_of(&all->items[k - 1]) : 0);
    return fmin(vowel->end + MIN_RAMP, k + 1 < all->count ? begin_of(&all->items[k + 1]) : all->g->end);
}

/* Shifts contact k so that the vowels beside it keep their time, or lose it equally. */
static void give_way(struct drafts *all, size_t k) {
    struct draft *d = &all->items[k];
    const struct phone_segment *left = vowel_beside(all, k, true), *right = vowel_beside(all, k, false);
    double least = -INFINITY, most = INFINITY;
    if (left) {
        double begin = fmin(room_edge(all, k, left, true) + VOWEL_ROOM, left->end + MIN_RAMP);
        most = d->begin - begin;
    }
    if (right) {
        double end = fmax(room_edge(all, k, right, false) - VOWEL_ROOM, right->start - MIN_RAMP);
        least = d->end + d->extra - end;
    }
    double before = least > most ? (least + most) / 2 : clamp(d->before, least, most);
    d->before = clamp(before, d->least, d->most);
}

/* Duration of the lips' movement to or from contact k. */
static double ramp(const struct drafts *all, size_t k, bool before) {
    const struct draft *d = &all->items[k];
    size_t i = before ? d->first : d->last;
    const struct phone_segment *n = beside(all->g, i, before);
    double side = before ? 1 : -1, edge = before ? begin_of(d) : end_of(d);
    double way = side * (edge - limit(all->g, i, before, 0.5));
    if (n && is_vowel(n)) {
        double other = room_edge(all, k, n, before), room = side * (edge - other);
        bool shared = before ? other > n->start - MIN_RAMP : other < n->end + MIN_RAMP;
        way = fmin(way, (room - VOWEL_OPEN) / (shared ? 2 : 1));
    }
    return clamp(way, MIN_RAMP, MAX_RAMP);
}

/* The contact of one phone. */
static struct draft own(const struct phone_segments *g, size_t i) {
    const struct phone_segment *item = &g->items[i];
    const struct contact_rule *rule = &item->phone->contact;
    double length = (item->end - item->start) / item->phones;
    return (struct draft){.rule = rule,
                          .first = i,
                          .last = i,
                          .begin = item->start + fmin(rule->onset, CONTACT_MAX_ONSET * length),
                          .end = item->end - fmin(rule->release, CONTACT_MAX_RELEASE * length)};
}

static void draft_all(struct drafts *all) {
    const struct phone_segments *g = all->g;
    for (size_t i = 0; i < g->count; i++) {
        if (!kind_of(&g->items[i]))
            continue;
        struct draft d = own(g, i);
        while (d.last + 1 < g->count &&
               kind_of(&g->items[d.last + 1]) == d.rule->kind) { /* consecutive contacts of a kind merge */
            struct draft next = own(g, ++d.last);
            d.end = next.end;
            if (next.rule->press > d.rule->press)
                d.rule = next.rule;
        }
        stretch(g, &d);
        all->items = mem_grow(all->items, &all->cap, all->count + 1, sizeof *all->items);
        all->items[all->count++] = d;
        i = d.last;
    }
}

void contacts_from(const struct phone_segments *g, struct contacts *out) {
    struct drafts all = {.g = g};
    draft_all(&all);
    for (int round = 0; round < ROUNDS; round++)
        for (size_t k = 0; k < all.count; k++)
            give_way(&all, k);
    *out = (struct contacts){.items = mem_alloc((all.count + 1) * sizeof *out->items), .count = all.count};
    for (size_t k = 0; k < all.count; k++) {
        const struct contact_rule *rule = all.items[k].rule;
        double out_of = ramp(&all, k, false), begin = begin_of(&all.items[k]);
        double earlier = rule->kind == CONTACT_LIPS ? UNPRESSING * out_of : 0;
        out->items[k] = (struct contact){.rule = rule,
                                         .begin = begin,
                                         .end = fmax(begin, end_of(&all.items[k]) - earlier),
                                         .ramp_in = ramp(&all, k, true),
                                         .ramp_out = out_of};
    }
    free(all.items);
}

void contacts_free(struct contacts *contacts) {
    free(contacts->items);
    *contacts = (struct contacts){0};
}

static double weight_at(const struct contact *c, double t) {
    double outside = t < c->begin ? (c->begin - t) / c->ramp_in : t > c->end ? (t - c->end) / c->ramp_out : 0;
    if (outside >= 1)
        return 0;
    double x = 1 - outside;
    return x * x * (3 - 2 * x);
}

static void demand_at(const struct contacts *contacts, double t, size_t *cursor,
                      struct contact_demand demand[CONTACT_TEETH + 1]) {
    for (int k = 0; k <= CONTACT_TEETH; k++)
        demand[k] = (struct contact_demand){0};
    size_t i = *cursor;
    while (i > 0 && t < contacts->items[i - 1].end + MAX_RAMP)
        i--;
    while (i < contacts->count && t > contacts->items[i].end + MAX_RAMP)
        i++;
    *cursor = i;
    for (; i < contacts->count && t > contacts->items[i].begin - MAX_RAMP; i++) {
        const struct contact *c = &contacts->items[i];
        double weight = weight_at(c, t);
        if (weight > demand[c->rule->kind].weight)
            demand[c->rule->kind] = (struct contact_demand){c->rule, weight};
    }
}

void contacts_at(const struct contacts *contacts, double t, double period, size_t *cursor,
                 struct contact_demand demand[CONTACT_TEETH + 1]) {
    demand_at(contacts, t, cursor, demand);
    size_t i = *cursor;
    while (i > 0 && contacts->items[i - 1].end > t - period)
        i--;
    for (; i < contacts->count && contacts->items[i].begin < t + period; i++) {
        const struct contact *c = &contacts->items[i];
        double middle = (c->begin + c->end) / 2 - t;
        bool between = (c->begin > t && c->end < t + period) || (c->end < t && c->begin > t - period);
        if (between && middle >= -period / 2 && middle < period / 2)
            demand[c->rule->kind] = (struct contact_demand){c->rule, 1};
    }
}

/* Share of a vowel in its middle during which it must be open; longer in short vowels, so that one frame
 * at 25 fps falls into it if the contacts leave room. */
#define MIDDLE 0.3
#define MIN_SECONDS 0.042

static double own_opening(const struct phone_segment *g) {
    const struct coefficients *plain = g->phone->plain + VOWEL_CONTEXT_PAUSE * PARAM_COUNT,
                              *stressed = g->phone->stressed + VOWEL_CONTEXT_PAUSE * PARAM_COUNT;
    double a = plain[PARAM_LI].T + plain[PARAM_LS].T, b = stressed[PARAM_LI].T + stressed[PARAM_LS].T;
    return a + g->stress * (b - a);
}

/* The time between contacts around the instant, at most MAX_RAMP beyond the vowel on each side, and within
 * the audio. */
static void room_of(const struct phone_segment *g, double audio_end, const struct contacts *contacts,
                    size_t *next, double *earliest, double *latest) {
    double middle = (g->start + g->end) / 2;
    while (*next < contacts->count && contacts->items[*next].begin + contacts->items[*next].end < 2 * middle)
        ++*next;
    *earliest = fmax(MIN_RAMP, g->start - MAX_RAMP);
    *latest = fmin(audio_end - MIN_RAMP, g->end + MAX_RAMP);
    if (*next)
        *earliest = fmax(*earliest, contacts->items[*next - 1].end);
    if (*next < contacts->count)
        *latest = fmin(*latest, contacts->items[*next].begin);
}

static double opening_ramp(double room) {
    return fmin(MAX_RAMP, fmax(MIN_RAMP, room));
}

void openings_from(const struct phone_segments *g, const struct contacts *contacts, struct openings *out) {
    *out = (struct openings){0};
    size_t next = 0;
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (!item->phone || !item->phone->group->vowel)
            continue;
        double length = item->end - item->start, own = own_opening(item), earliest, latest;
        room_of(item, g->end, contacts, &next, &earliest, &latest);
        double middle = fmin(fmax((item->start + item->end) / 2, earliest), latest);
        if (own <= 0 || latest <= earliest)
            continue;
        double half = fmax(MIDDLE * length, MIN_SECONDS) / 2;
        /* beside a contact, the movement is the contact's */
        struct opening o = {
            .begin = fmax(middle - half, earliest),
            .end = fmin(middle + half, latest),
            .gap = own * (OPENING_SHORT + (OPENING_FULL - OPENING_SHORT) * fmin(1, length / OPENING_LONG))};
        o.ramp_in = opening_ramp(o.begin - earliest);
        o.ramp_out = opening_ramp(latest - o.end);
        out->items = mem_grow(out->items, &out->cap, out->count + 1, sizeof *out->items);
        out->items[out->count++] = o;
    }
}

void openings_free(struct openings *openings) {
    free(openings->items);
    *openings = (struct openings){0};
}

/* A minimum-jerk movement (Nelson, Biol. Cybern. 46, 1983). */
static double opening_weight(const struct opening *o, double t) {
    double outside = t < o->begin ? (o->begin - t) / o->ramp_in : t > o->end ? (t - o->end) / o->ramp_out : 0;
    double x = 1 - outside;
    return outside >= 1 ? 0 : x * x * x * (10 - 15 * x + 6 * x * x);
}

void openings_show(const struct openings *openings, double t, size_t *cursor, const struct speech_fapu *fapu,
                   double faps[FAP_COUNT + 1]) {
    size_t i = *cursor;
    while (i > 0 && t < openings->items[i - 1].end + MAX_RAMP)
        i--;
    while (i < openings->count && t > openings->items[i].end + MAX_RAMP)
        i++;
    *cursor = i;
    for (; i < openings->count && t > openings->items[i].begin - MAX_RAMP; i++)
        fapmap_open(fapu, openings->items[i].gap, opening_weight(&openings->items[i], t), faps);
}

/* Thresholds of rounded lips: protrusion, or narrowing, in mm. */
#define ROUNDED_PUSH 1.0
#define ROUNDED_WIDTH (-0.7)
/* Dominance from which a sound rounds the lips itself, and below which it is neutral. */
#define ROUNDED_ALPHA 0.5
#define CARELESS 0.3
/* Dominance given to the neutral sounds between. */
#define HELD 0.6

static bool rounds(const struct coefficients *c, enum speech_param param) {
    return c->alpha >= ROUNDED_ALPHA && (param == PARAM_AR ? c->T <= ROUNDED_WIDTH : c->T >= ROUNDED_PUSH);
}

void rounding_trough(const struct phone_segments *g, enum speech_param param, double trough,
                     struct coefficients *c) {
    if (param != PARAM_AR && param != PARAM_PI && param != PARAM_PS)
        return;
    size_t last = g->count; /* last rounded segment, with only neutral ones since */
    for (size_t i = 0; i < g->count; i++) {
        if (!g->items[i].phone || (c[i].alpha > CARELESS && !rounds(&c[i], param))) {
            last = g->count;
        } else if (rounds(&c[i], param)) {
            double between = last < i ? (1 - trough) * (c[last].T + c[i].T) / 2 : 0;
            for (size_t k = last + 1; k < i; k++) {
                if (g->items[k].phone->contact.kind)
                    continue; /* the lips have a contact */
                c[k].T = between;
                c[k].alpha = c[k].k = HELD;
            }
            last = i;
        }
    }
}
