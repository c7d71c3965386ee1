/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/opening.h"
#include "server/base/mem.h"
#include "server/face/engines/fapmap.h"
#include <math.h>
#include <stdlib.h>

/* The part of a vowel's time, in its middle, for which it is to be open; longer in short ones, so that one
 * frame of 25 a second falls into it where the contacts leave room. */
#define MIDDLE 0.3
#define MIN_SECONDS 0.042
#define MAX_RAMP 0.07
#define MIN_RAMP 0.01

static double own_opening(const struct phone_segment *g) {
    const struct coefficients *plain = g->phone->plain + VOWEL_CONTEXT_PAUSE * PARAM_COUNT,
                              *stressed = g->phone->stressed + VOWEL_CONTEXT_PAUSE * PARAM_COUNT;
    double a = plain[PARAM_LI].T + plain[PARAM_LS].T, b = stressed[PARAM_LI].T + stressed[PARAM_LS].T;
    return a + g->stress * (b - a);
}

/* The time that contacts leave round the instant, at most MAX_RAMP on each side of the vowel, and within
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

static double ramp(double room) {
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
        /* Beside a contact the lips' way is the contact's. */
        struct opening o = {
            .begin = fmax(middle - half, earliest),
            .end = fmin(middle + half, latest),
            .gap = own * (OPENING_SHORT + (OPENING_FULL - OPENING_SHORT) * fmin(1, length / OPENING_LONG))};
        o.ramp_in = ramp(o.begin - earliest);
        o.ramp_out = ramp(latest - o.end);
        out->items = mem_grow(out->items, &out->cap, out->count + 1, sizeof *out->items);
        out->items[out->count++] = o;
    }
}

void openings_free(struct openings *openings) {
    free(openings->items);
    *openings = (struct openings){0};
}

/* A stroke of least jerk (Nelson, Biol. Cybern. 46, 1983). */
static double weight_at(const struct opening *o, double t) {
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
        fapmap_open(fapu, openings->items[i].gap, weight_at(&openings->items[i], t), faps);
}
