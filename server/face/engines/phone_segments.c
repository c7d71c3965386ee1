/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/face/engines/phone_segments.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/face/packs/phone_match.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Shorter silences are artefacts of the voice, not pauses of the mouth. */
#define MIN_PAUSE 0.04

struct reporter {
    const struct speech_pack *pack;
    void (*warn)(void *ctx, const char *message);
    void *ctx;
    uint32_t reported[32];
    size_t count;
};

static void report(struct reporter *r, const char *ipa, const struct phone_matches *found) {
    if (!found->unknown || !r->warn)
        return;
    for (size_t i = 0; i < r->count; i++)
        if (r->reported[i] == found->unknown)
            return;
    if (r->count == sizeof r->reported / sizeof *r->reported)
        return;
    r->reported[r->count++] = found->unknown;
    char letter[5] = "", message[160];
    letter[utf8_put(found->unknown, letter)] = '\0';
    if (found->stand_in)
        snprintf(message, sizeof message,
                 "the %s speech pack has no phone \"%s\" (in \"%s\"): shown like \"%s\"", r->pack->lang,
                 letter, ipa, found->stand_in->ipa);
    else
        snprintf(message, sizeof message, "the %s speech pack has no phone \"%s\" (in \"%s\"): not shown",
                 r->pack->lang, letter, ipa);
    r->warn(r->ctx, message);
}

static void add(struct phone_segments *g, const struct speech_phone *phone, double start, double end,
                double stress) {
    struct phone_segment *last = g->count ? &g->items[g->count - 1] : NULL;
    if (last && last->phone == phone && (!phone || !speech_phone_is_vowel(phone))) {
        last->end = end;
        last->phones++;
        return;
    }
    g->items = mem_grow(g->items, &g->cap, g->count + 1, sizeof *g->items);
    g->items[g->count++] = (struct phone_segment){phone, start, end, stress, 1};
}

static bool has_stress(const struct sentence_audio *u) {
    for (size_t i = 0; i < u->phone_count; i++)
        if (u->phones[i].stress)
            return true;
    return false;
}

/* Merges pauses that are too short into the previous phone. */
static void drop_seams(struct phone_segments *g) {
    size_t kept = 0;
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment item = g->items[i];
        if (!item.phone && kept && item.end - item.start < MIN_PAUSE)
            g->items[kept - 1].end = item.end;
        else
            g->items[kept++] = item;
    }
    g->count = kept;
}

void phone_segments_from(const struct speech_pack *pack, const struct sentence_audio *u,
                         void (*warn)(void *ctx, const char *message), void *ctx,
                         struct phone_segments *out) {
    struct reporter reporter = {.pack = pack, .warn = warn, .ctx = ctx};
    double rate = u->sample_rate ? u->sample_rate : 1;
    bool knows_stress = has_stress(u);
    *out = (struct phone_segments){.end = u->samples / rate};
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        double start = p->start / rate, length = p->end > p->start ? (p->end - p->start) / rate : 0;
        double stress = knows_stress ? p->stress / 2.0 : 0.5;
        struct phone_matches found;
        phone_match_find(pack, p->ipa, &found);
        report(&reporter, p->ipa, &found);
        if (!found.count && !p->ipa[0])
            add(out, NULL, start, start + length, 0);
        for (size_t k = 0; k < found.count; k++) {
            double end = start + length * found.match[k].share;
            add(out, found.match[k].phone, start, end, stress);
            start = end;
        }
    }
    drop_seams(out);
}

void phone_segments_free(struct phone_segments *g) {
    free(g->items);
    *g = (struct phone_segments){0};
}
