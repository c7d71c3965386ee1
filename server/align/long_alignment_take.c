/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a long alignment hands out of a piece: its phones and words with their times, and how sure they are.
 */
#include "server/align/long_alignment_internal.h"
#include "server/base/mem.h"
#include <math.h>
#include <string.h>

/* Pauses between phones that are shorter than this belong to the phone before, s. */
#define PAUSE_LEAST 0.03
#define PHONE_LEAST 0.02
/* Shares of other words' distance at which a piece is certain, and worth nothing (chance_distance.h). */
#define CERTAIN 0.86
#define WORTHLESS 1.0
/* A word of which one moment is held for so long is doubtful, and worth nothing, s. */
#define HELD_DOUBTFUL 0.25
#define HELD_WORTHLESS 0.9
/* A word that takes so many times as long as the voice's has a pause or noise in it, or sounds of its
 * neighbours: what is beyond that counts as held. */
#define DRAWN_OUT 3.0
/* A word is too short to be judged by itself: so many on both sides count, too. */
enum { BESIDE = 2 };

static double seconds_of(const struct fit *fit, uint64_t at) {
    return (double)window_place(fit->window, fit->base + (size_t)at) / fit->window->source->rate;
}

static uint64_t inside(const struct fit *fit, uint64_t sample) {
    return sample > fit->from ? sample - fit->from : 0;
}

double fit_time(const struct fit *fit, uint64_t sample) {
    return seconds_of(fit, align_time(fit->map, inside(fit, sample)));
}

static double end_time(const struct fit *fit, uint64_t sample) {
    return seconds_of(fit, align_end_time(fit->map, inside(fit, sample)));
}

static double apart_of(const struct fit *fit, uint64_t from, uint64_t to) {
    return align_apart(fit->map, inside(fit, from), inside(fit, to));
}

static double confidence(double apart) {
    return fmax(0, fmin(1, (WORTHLESS - apart) / (WORTHLESS - CERTAIN)));
}

/* The warp may leave a phone no time of its own; its neighbour that has more of it gives it some. */
static void widen(struct long_alignment_piece *piece, size_t i) {
    struct long_alignment_phone *p = &piece->phones[i], *before = i ? p - 1 : NULL;
    struct long_alignment_phone *after = i + 1 < piece->phone_count ? p + 1 : NULL;
    double missing = PHONE_LEAST - (p->end - p->start);
    double left = before ? p->start - before->start : 0, right = after ? after->end - p->end : 0;
    if (missing <= 0)
        return;
    if (left >= right && left > missing + PHONE_LEAST) {
        p->start -= missing;
        before->end = fmin(before->end, p->start);
    } else if (right > missing + PHONE_LEAST) {
        p->end += missing;
        after->start = fmax(after->start, p->end);
    }
}

static void take_phones(const struct fit *fit, const struct reference_span *span,
                        struct long_alignment_piece *piece) {
    piece->phones = mem_alloc((span[1].phones - span->phones + 1) * sizeof *piece->phones);
    for (size_t i = span->phones; i < span[1].phones; i++) {
        const struct reference_phone *from = &fit->said->speech.phones[i];
        struct long_alignment_phone *p = &piece->phones[piece->phone_count];
        struct long_alignment_phone *before = piece->phone_count ? p - 1 : NULL;
        if (!*from->ipa)
            continue;
        p->start = fit_time(fit, from->start);
        p->end = fmax(p->start, end_time(fit, from->end));
        p->stress = from->stress;
        memcpy(p->ipa, from->ipa, sizeof p->ipa);
        if (before && p->start - before->end < PAUSE_LEAST)
            before->end = p->start;
        piece->phone_count++;
    }
    for (size_t i = 0; i < piece->phone_count; i++)
        widen(piece, i);
}

/* How sure word i is, which takes `took` seconds: by the sound of it and of its neighbours, on the piece's
 * scale, and by how it lasts. */
static double word_confidence(const struct fit *fit, const struct reference_span *span, size_t i, double took,
                              const struct long_alignment_piece *piece, double apart) {
    const struct reference_word *words = fit->said->speech.words;
    size_t first = i >= span->words + BESIDE ? i - BESIDE : span->words, last = i + BESIDE + 1;
    uint64_t end = last < span[1].words ? words[last].start : span->end;
    uint64_t own = i + 1 < span[1].words ? words[i + 1].start : span->end;
    double here = apart_of(fit, words[first].start, end);
    double spoken = (double)(own - words[i].start) / fit->said->speech.rate;
    double held =
        fmax(align_held(fit->map, inside(fit, words[i].start), inside(fit, own)), took - DRAWN_OUT * spoken);
    double lasts = fmax(0, fmin(1, (HELD_WORTHLESS - held) / (HELD_WORTHLESS - HELD_DOUBTFUL)));
    return lasts *
           (here < 0 || piece->apart <= 0 ? confidence(apart) : confidence(apart * here / piece->apart));
}

/* A word ends with its last phone. */
static void take_words(const struct fit *fit, const struct reference_span *span,
                       struct long_alignment_piece *piece, double apart) {
    size_t phone = 0;
    piece->words = mem_alloc((span[1].words - span->words + 1) * sizeof *piece->words);
    for (size_t i = span->words; i < span[1].words; i++) {
        const struct reference_word *from = &fit->said->speech.words[i];
        struct long_alignment_word *w = &piece->words[piece->word_count++];
        *w = (struct long_alignment_word){
            .from = from->from, .to = from->to, .start = fit_time(fit, from->start)};
        w->end = w->start;
        double next = i + 1 < span[1].words ? fit_time(fit, from[1].start) : INFINITY;
        for (; phone < piece->phone_count && piece->phones[phone].start < next - 1e-9; phone++)
            w->end = fmax(w->end, piece->phones[phone].end);
        w->end = fmin(w->end, fmax(w->start, next));
        w->confidence = word_confidence(fit, span, i, w->end - w->start, piece, apart);
    }
}

static struct long_alignment_piece *add(struct long_alignment *c, const struct reference_span *span) {
    c->ready = mem_grow(c->ready, &c->ready_cap, c->ready_count + 1, sizeof *c->ready);
    struct long_alignment_piece *piece = &c->ready[c->ready_count++];
    *piece = (struct long_alignment_piece){.from = span->from, .to = span->to};
    return piece;
}

void long_alignment_take(struct long_alignment *c, const struct fit *fit, const struct reference_span *span,
                         double apart) {
    struct long_alignment_piece *piece = add(c, span);
    piece->found = true;
    piece->apart = apart_of(fit, span->start, span->end);
    piece->confidence = confidence(apart);
    take_phones(fit, span, piece);
    take_words(fit, span, piece, apart);
    piece->start = piece->end = fit_time(fit, span->start);
    if (piece->phone_count) {
        piece->start = piece->phones[0].start;
        piece->end = piece->phones[piece->phone_count - 1].end;
    }
    c->until = piece->end;
    c->found = true;
}

void long_alignment_miss(struct long_alignment *c, const struct reference_span *span) {
    struct long_alignment_piece *piece = add(c, span);
    piece->start = piece->end = c->until;
    piece->apart = -1;
}
