/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/chance_distance.h"
#include "server/align/long_alignment_internal.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Pauses between phones that are shorter than this belong to the phone before, s. */
#define PAUSE_LEAST 0.03
#define PHONE_LEAST 0.02
#define REST_ENOUGH 60.0

void long_alignment_piece_free(struct long_alignment_piece *piece) {
    free(piece->phones);
    free(piece->words);
    *piece = (struct long_alignment_piece){0};
}

struct long_alignment *long_alignment_open(const struct sound_source *source, struct reference *reference,
                                           const char *text, size_t size,
                                           const struct long_alignment_options *options, struct error *e) {
    static const char *const genders[] = {"male", "female"};
    struct long_alignment *c = mem_alloc(sizeof *c);
    c->reference = reference;
    c->text = text;
    c->size = size;
    c->stop = options->stop;
    c->made = options->made;
    for (int pass = 0; pass < 2 && !c->voice_count; pass++) /* a gender that there is no voice of: any */
        for (int i = 0; i < 2; i++) {
            const char *voice = reference_voice(reference, options->lang, genders[i]);
            if (*voice && (pass || !options->gender || !strcmp(options->gender, genders[i]) ||
                           !strcmp(options->gender, "neutral")))
                c->voices[c->voice_count++] = voice;
        }
    window_open(&c->window, source);
    if (c->voice_count)
        return c;
    error_set(e, ERROR_NO_REFERENCE, "no voice to align to speaks '%.40s'", options->lang);
    long_alignment_free(c);
    return NULL;
}

void long_alignment_free(struct long_alignment *c) {
    if (!c)
        return;
    for (; c->ready_at < c->ready_count; c->ready_at++)
        long_alignment_piece_free(&c->ready[c->ready_at]);
    free(c->ready);
    window_close(&c->window);
    reference_free(&c->speech);
    free(c);
}

static bool to_the_end(const struct long_alignment *c) {
    return c->spans[c->span_count].from == c->size;
}

/* Time of a sample of the window. */
static double seconds_of(const struct long_alignment *c, uint64_t sample) {
    return (double)window_place(&c->window, (size_t)sample) / c->window.source->rate;
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

static void take_phones(const struct long_alignment *c, const struct align_map *map,
                        const struct reference_span *span, struct long_alignment_piece *piece) {
    piece->phones = mem_alloc((span[1].phones - span->phones + 1) * sizeof *piece->phones);
    for (size_t i = span->phones; i < span[1].phones; i++) {
        const struct reference_phone *from = &c->speech.phones[i];
        struct long_alignment_phone *p = &piece->phones[piece->phone_count];
        struct long_alignment_phone *before = piece->phone_count ? p - 1 : NULL;
        if (!*from->ipa)
            continue;
        p->start = seconds_of(c, align_time(map, from->start));
        p->end = fmax(p->start, seconds_of(c, align_end_time(map, from->end)));
        p->stress = from->stress;
        memcpy(p->ipa, from->ipa, sizeof p->ipa);
        if (before && p->start - before->end < PAUSE_LEAST)
            before->end = p->start;
        piece->phone_count++;
    }
    for (size_t i = 0; i < piece->phone_count; i++)
        widen(piece, i);
}

/* A word ends with its last phone. */
static void take_words(const struct long_alignment *c, const struct align_map *map,
                       const struct reference_span *span, struct long_alignment_piece *piece) {
    size_t phone = 0;
    piece->words = mem_alloc((span[1].words - span->words + 1) * sizeof *piece->words);
    for (size_t i = span->words; i < span[1].words; i++) {
        const struct reference_word *from = &c->speech.words[i];
        struct long_alignment_word *w = &piece->words[piece->word_count++];
        *w = (struct long_alignment_word){from->from, from->to, seconds_of(c, align_time(map, from->start)),
                                          0};
        w->end = w->start;
        double next = i + 1 < span[1].words ? seconds_of(c, align_time(map, from[1].start)) : INFINITY;
        for (; phone < piece->phone_count && piece->phones[phone].start < next - 1e-9; phone++)
            w->end = fmax(w->end, piece->phones[phone].end);
        w->end = fmin(w->end, fmax(w->start, next));
    }
}

static void take(struct long_alignment *c, const struct align_map *map, const struct reference_span *span) {
    c->ready = mem_grow(c->ready, &c->ready_cap, c->ready_count + 1, sizeof *c->ready);
    struct long_alignment_piece *piece = &c->ready[c->ready_count++];
    *piece = (struct long_alignment_piece){.from = span->from, .to = span->to};
    take_phones(c, map, span, piece);
    take_words(c, map, span, piece);
    piece->apart = align_apart(map, span->start, span->end);
    piece->start = piece->end = seconds_of(c, align_time(map, span->start));
    if (piece->phone_count) {
        piece->start = piece->phones[0].start;
        piece->end = piece->phones[piece->phone_count - 1].end;
    }
}

static int misfit(const struct long_alignment *c, size_t byte, double time, const char *why,
                  struct error *e) {
    size_t line = 1, column = 1;
    for (size_t i = 0; i < byte; i++) {
        column += (c->text[i] & 0xC0) != 0x80;
        if (c->text[i] == '\n') {
            line++;
            column = 1;
        }
    }
    int minutes = (int)(time / 60);
    return error_at_line(e, ERROR_MISALIGNED, line, column, "%s, at %d:%04.1f of the recording", why, minutes,
                         time - 60.0 * minutes);
}

/* Are these the words of the recording? */
static int check(const struct long_alignment *c, const struct align_map *map, size_t count, struct error *e) {
    if (c->made)
        return 0;
    const struct align_sound recording = {c->window.pcm, map->measured_speech_samples,
                                          c->window.source->rate};
    double apart, other = chance(&recording, &c->speech, map, c->stop, &apart);
    if (other < 0 || apart < CHANCE_SHARE * other)
        return 0;
    size_t worst = 0; /* the first that is no nearer than chance */
    while (worst + 1 < count &&
           align_apart(map, c->spans[worst].start, c->spans[worst].end) < CHANCE_SHARE * other)
        worst++;
    return misfit(c, c->spans[worst].from, seconds_of(c, align_time(map, c->spans[worst].start)),
                  "the words are not those of the recording", e);
}

/* Aligns some pieces more. */
static int advance(struct long_alignment *c, struct error *e) {
    struct align_map map;
    double here = seconds_of(c, 0);
    bool begins = !c->at && !c->pace;
    if (c->voice_count > 1 && long_alignment_choose_voice(c, e))
        return -1;
    if (long_alignment_speak(c, c->voices[0], e) ||
        (begins && c->speech.word_count && long_alignment_choose_start(c, e)))
        return -1;
    if (!c->speech.word_count) { /* nothing to be said in it */
        c->at = c->spans[c->span_count].from;
        return 0;
    }
    if (long_alignment_find(c, &map)) {
        align_free(&map);
        return long_alignment_stopped(c) ? long_alignment_cancelled(e)
                                         : misfit(c, c->at, here, "the recording ends before the text", e);
    }
    size_t count = to_the_end(c) ? c->span_count : c->span_count - 1;
    int result = check(c, &map, count, e);
    if (long_alignment_stopped(c))
        result = long_alignment_cancelled(e);
    uint64_t begin = align_time(&map, 0), end = align_end_time(&map, c->spans[count - 1].end);
    c->ready_at = c->ready_count = 0;
    for (size_t i = 0; i < count && !result; i++)
        take(c, &map, &c->spans[i]);
    if (!result && end > begin)
        c->pace = (double)(end - begin) / c->window.source->rate /
                  ((double)c->spans[count - 1].end / c->speech.rate);
    align_free(&map);
    if (result)
        return -1;
    window_drop(&c->window, (size_t)end);
    c->at = c->spans[count].from;
    return 0;
}

int long_alignment_next(struct long_alignment *c, struct long_alignment_piece *piece, struct error *e) {
    while (c->ready_at == c->ready_count) {
        if (c->at == c->size)
            return 0;
        if (advance(c, e))
            return -1;
    }
    *piece = c->ready[c->ready_at];
    c->ready[c->ready_at++] = (struct long_alignment_piece){0};
    return 1;
}

double long_alignment_rest(struct long_alignment *c) {
    return window_rest(&c->window, window_place(&c->window, 0), REST_ENOUGH);
}
