/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/eval/stretch.h"
#include "server/base/mem.h"
#include "server/face/engines/contact.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Shown before the first and after the last word, s. */
#define MARGIN 0.1

struct range {
    double begin, end;
};

static struct range range_of(const struct sentence_audio *u, size_t first, size_t count) {
    double rate = u->sample_rate, end = u->samples / rate;
    if (!count) /* a sentence without words is shown whole */
        return (struct range){0, end};
    return (struct range){fmax(0, u->words[first].start / rate - MARGIN),
                          fmin(end, u->words[first + count - 1].end / rate + MARGIN)};
}

static size_t contacts_in(const struct contacts *contacts, struct range r) {
    size_t count = 0;
    for (size_t i = 0; i < contacts->count; i++)
        count += contacts->items[i].begin >= r.begin && contacts->items[i].end <= r.end;
    return count;
}

bool stretch_choose(struct stretch_choice *choice, const struct speech_pack *pack,
                    const struct sentence_audio *u, size_t number) {
    struct phone_segments g;
    struct contacts contacts;
    bool better = false;
    size_t words = u->word_count < STRETCH_WORDS ? u->word_count : STRETCH_WORDS;
    phone_segments_from(pack, u, NULL, NULL, &g);
    contacts_from(&g, &contacts);
    for (size_t first = 0; first + words <= u->word_count; first++) {
        size_t found = contacts_in(&contacts, range_of(u, first, words));
        if ((!number && !first) || found > choice->contacts) {
            *choice = (struct stretch_choice){number, first, words, found};
            better = true;
        }
    }
    contacts_free(&contacts);
    phone_segments_free(&g);
    return better;
}

static void note_phones(struct stretch *s, const struct phone_segments *g, struct range r) {
    struct contacts contacts;
    s->phone_count = s->span_count = 0;
    for (size_t i = 0; i < g->count; i++) {
        const struct phone_segment *item = &g->items[i];
        if (item->end <= r.begin || item->start >= r.end)
            continue;
        s->phones = mem_grow(s->phones, &s->phone_cap, s->phone_count + 1, sizeof *s->phones);
        struct stretch_phone *p = &s->phones[s->phone_count++];
        *p = (struct stretch_phone){.start = fmax(item->start, r.begin) - r.begin,
                                    .end = fmin(item->end, r.end) - r.begin};
        snprintf(p->label, sizeof p->label, "%s%s", item->phone ? item->phone->ipa : "",
                 item->phones > 1 && item->phone ? "ː" : "");
    }
    contacts_from(g, &contacts);
    for (size_t i = 0; i < contacts.count; i++) {
        const struct contact *c = &contacts.items[i];
        if (c->end <= r.begin || c->begin >= r.end)
            continue;
        s->spans = mem_grow(s->spans, &s->span_cap, s->span_count + 1, sizeof *s->spans);
        s->spans[s->span_count++] = (struct stretch_span){
            fmax(c->begin, r.begin) - r.begin, fmin(c->end, r.end) - r.begin, c->rule->kind == CONTACT_TEETH};
    }
    contacts_free(&contacts);
}

void stretch_take(struct stretch *s, const struct stretch_choice *choice, const struct eval_input *in,
                  size_t engine) {
    struct range r = range_of(in->audio, choice->first, choice->count);
    struct phone_segments g;
    phone_segments_from(in->pack, in->audio, NULL, NULL, &g);
    s->seconds = r.end - r.begin;
    note_phones(s, &g, r);
    for (int i = 0; i <= STRETCH_STEPS; i++) {
        struct fap_frame frame;
        in->face.sample(in->face.self, r.begin + s->seconds * i / STRETCH_STEPS, &frame);
        s->gaps[engine][i] = (float)eval_gap(in->pack, &frame);
    }
    phone_segments_free(&g);
}

void stretch_free(struct stretch *s) {
    free(s->phones);
    free(s->spans);
    *s = (struct stretch){0};
}
