/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/voice/boundary_table.h"
#include "server/voice/boundary_table_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Length marks, aspiration and other small letters, and what is written over or under a letter. */
static bool is_diacritic(uint32_t c) {
    return (c >= 0x2B0 && c <= 0x36F) || (c >= 0x1DC0 && c <= 0x1DFF);
}

/* The phone's first letter, or its last; 0 for a pause. */
static uint32_t letter_of(const struct phone *p, bool last) {
    uint32_t found = 0, c;
    size_t length, left = strlen(p->ipa);
    for (const char *s = p->ipa; left && (length = utf8_next(s, left, &c)) > 0; s += length, left -= length)
        if (!is_diacritic(c) && (last || !found))
            found = c;
    return found;
}

static bool has_letter(const char *letters, uint32_t letter) {
    uint32_t c;
    size_t length, left = strlen(letters);
    for (; left && (length = utf8_next(letters, left, &c)) > 0; letters += length, left -= length)
        if (c == letter)
            return true;
    return false;
}

static double shift_of(const struct voice_boundaries *b, const struct phone *before,
                       const struct phone *after) {
    uint32_t last = letter_of(before, true), first = letter_of(after, false);
    for (size_t i = 0; last && first && i < b->count; i++)
        if (has_letter(b->rules[i].before, last) && has_letter(b->rules[i].after, first))
            return b->rules[i].seconds;
    return 0;
}

/* Where phones began before, and the last one's end; and the phones as they are now. */
struct warp {
    const uint32_t *was;
    const struct phone *phones;
    size_t count, at;
};

/* A time goes with the phone in which it lies. Times come in their order. */
static uint32_t warped(struct warp *w, uint32_t t) {
    while (w->at + 1 < w->count && t >= w->was[w->at + 1])
        w->at++;
    uint32_t from = w->was[w->at], length = w->was[w->at + 1] - from;
    const struct phone *p = &w->phones[w->at];
    if (t < from || !length || t >= w->was[w->count])
        return t;
    return p->start + (uint32_t)((uint64_t)(t - from) * (p->end - p->start) / length);
}

/* A phone without a length gets none either: times beside it would not know to which side they belong. */
static void move_phones(const struct voice_boundaries *b, struct sentence_audio *u, const uint32_t *was) {
    for (size_t i = 1; i < u->phone_count; i++) {
        struct phone *before = &u->phones[i - 1], *after = &u->phones[i];
        double earliest = (was[i] - was[i - 1]) / BOUNDARY_PART,
               latest = (was[i + 1] - was[i]) / BOUNDARY_PART;
        if (!earliest || !latest)
            continue;
        double shift = fmax(-earliest, fmin(latest, round(shift_of(b, before, after) * u->sample_rate)));
        before->end = after->start = (uint32_t)(was[i] + shift);
    }
}

void boundaries_correct(const struct voice_boundaries *b, struct sentence_audio *u) {
    if (!b || !u->phone_count)
        return;
    uint32_t *was = mem_alloc((u->phone_count + 1) * sizeof *was);
    for (size_t i = 0; i < u->phone_count; i++)
        was[i] = u->phones[i].start;
    was[u->phone_count] = u->phones[u->phone_count - 1].end;
    move_phones(b, u, was);
    struct warp words = {was, u->phones, u->phone_count, 0}, marks = words;
    for (size_t i = 0; i < u->word_count; i++) {
        u->words[i].start = warped(&words, u->words[i].start);
        u->words[i].end = warped(&words, u->words[i].end);
    }
    for (size_t i = 0; i < u->mark_count; i++)
        u->marks[i].at = warped(&marks, u->marks[i].at);
    free(was);
}
