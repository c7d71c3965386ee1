/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/contact.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

/* Of a stretched contact's extra time, the part that comes before the sound: viewers forgive early lips less
 * than late ones, but the release must not swallow the next vowel. */
#define STRETCH_BEFORE 0.6
/* Of a vowel's time, what a stretched contact takes on its side while there is any on the other. */
#define VOWEL_GIVES 0.25
#define MAX_RAMP 0.07
#define MIN_RAMP 0.01

static enum contact_kind kind_of(const struct phone_segment *g) {
    return g->phone ? g->phone->contact.kind : CONTACT_NONE;
}

/* The instant up to which a contact may be felt on one side: that part of the neighbour, or none of it when
 * it has a contact itself. */
static double limit(const struct phone_segments *g, size_t i, bool before, double part) {
    if (before ? i == 0 : i + 1 == g->count)
        return before ? g->items[i].start - MAX_RAMP : g->items[i].end + MAX_RAMP;
    const struct phone_segment *n = &g->items[before ? i - 1 : i + 1];
    if (kind_of(n))
        return before ? n->end : n->start;
    if (!n->phone)
        return before ? fmax(n->end - MAX_RAMP, (n->start + n->end) / 2)
                      : fmin(n->start + MAX_RAMP, (n->start + n->end) / 2);
    return before ? n->end - part * (n->end - n->start) : n->start + part * (n->end - n->start);
}

static double gives(const struct phone_segments *g, size_t i, bool before) {
    size_t neighbour = before ? i - 1 : i + 1;
    bool vowel = (before ? i > 0 : neighbour < g->count) && g->items[neighbour].phone &&
                 g->items[neighbour].phone->group->vowel;
    return limit(g, i, before, vowel ? VOWEL_GIVES : 0.5);
}

static void stretch(struct contact *c, double earliest, double latest) {
    double missing = CONTACT_MIN_SECONDS - (c->end - c->begin);
    if (missing <= 0)
        return;
    double before = fmax(STRETCH_BEFORE * missing, missing - fmax(0, latest - c->end));
    /* Where the neighbours are too short to give way by half, the contact goes before. */
    earliest = fmin(earliest, c->begin - CONTACT_MIN_SECONDS / 2);
    latest = fmax(latest, c->end + CONTACT_MIN_SECONDS / 2);
    double begin = fmax(earliest, c->begin - before);
    double end = fmin(latest, fmax(c->end, begin + CONTACT_MIN_SECONDS));
    c->begin = fmin(c->begin, fmax(earliest, end - CONTACT_MIN_SECONDS));
    c->end = end;
}

/* What would lie before the sentence's audio or after its end is shown within it: the face speaks only there.
 */
static void keep_inside(struct contact *c, double end) {
    if (c->begin < 0) {
        c->end = fmin(end, c->end - c->begin);
        c->begin = 0;
    }
    if (c->end > end) {
        c->begin = fmax(0, c->begin - (c->end - end));
        c->end = end;
    }
}

static double ramp(double room) {
    return fmin(MAX_RAMP, fmax(MIN_RAMP, room));
}

/* The time of one phone's contact. */
static struct contact own(const struct phone_segment *item) {
    const struct contact_rule *rule = &item->phone->contact;
    double length = (item->end - item->start) / item->phones;
    return (struct contact){.rule = rule,
                            .begin = item->start + fmin(rule->onset, CONTACT_MAX_ONSET * length),
                            .end = item->end - fmin(rule->release, CONTACT_MAX_RELEASE * length)};
}

void contacts_from(const struct phone_segments *g, struct contacts *out) {
    *out = (struct contacts){0};
    for (size_t i = 0; i < g->count; i++) {
        if (!kind_of(&g->items[i]))
            continue;
        size_t last = i;
        struct contact c = own(&g->items[i]);
        while (last + 1 < g->count && kind_of(&g->items[last + 1]) == c.rule->kind) { /* one for all */
            struct contact next = own(&g->items[++last]);
            c.end = next.end;
            if (next.rule->press > c.rule->press)
                c.rule = next.rule;
        }
        stretch(&c, gives(g, i, true), gives(g, last, false));
        keep_inside(&c, g->end);
        c.ramp_in = ramp(c.begin - limit(g, i, true, 0.5));
        c.ramp_out = ramp(limit(g, last, false, 0.5) - c.end);
        out->items = mem_grow(out->items, &out->cap, out->count + 1, sizeof *out->items);
        out->items[out->count++] = c;
        i = last;
    }
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

void contacts_at(const struct contacts *contacts, double t, size_t *cursor,
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
