/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/library/align/long_alignment_internal.h"
#include "server/markup/plain.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- speaking and locating the next pieces ---- */

/* Amount of synthetic speech to locate at once, at least two pieces; pieces are not cut below the least
 * size. */
const struct speak_amount long_alignment_window = {20, 40};
/* Longest piece in bytes (about 13 s). */
enum { PIECE_BYTES = 200, TRIES = 3 };
/* Slowest reading pace relative to the reference, until it is known. */
#define PACE_FIRST 1.7
/* The window exceeds the expected length by this factor and these seconds. */
#define WINDOW_FACTOR 1.35
#define WINDOW_MORE 3.0
/* A path that ends within this share of the window's end may be cut off. */
#define NEAR_END 0.03
/* At the start: places to try if the first words (s) are so much more distant than the rest; each must be
 * this much better than those before. */
#define FIRST_SECONDS 1.0
#define FIRST_APART 1.05
#define BETTER_START 0.98
enum { STARTS = 5 };
/* Music has no pause before the text: starts on a grid are tried, too, if the text took so much longer than
 * by the reference. A grid is coarse, so such a start must be clearly better. */
enum { GRID_STARTS = 12 };
#define GRID_SECONDS 1.5
#define GRID_PACE 1.25
#define BETTER_ON_GRID 0.93

/* Length of the first piece: a sentence, or up to a comma or space in a long one. */
static size_t piece_length(const char *text, size_t size, size_t least) {
    size_t length = plain_sentence(text, size, NULL), comma = 0, space = 0;
    while (length < least && length < size)
        length += plain_sentence(text + length, size - length, NULL);
    if (length <= PIECE_BYTES)
        return length;
    for (size_t i = PIECE_BYTES / 3; i < PIECE_BYTES; i++)
        if (text[i] == ' ' || text[i] == '\n') {
            space = i + 1;
            comma = strchr(",;:", text[i - 1]) ? i + 1 : comma;
        }
    return comma ? comma : space ? space : length;
}

int long_alignment_speak(struct long_alignment *c, struct spoken *out, const char *voice,
                         const struct speak_amount *amount, struct error *e) {
    struct reference_speech *s = &out->speech;
    size_t at = c->at;
    reference_clear(s);
    out->count = 0;
    while (at < c->size && out->count < PIECES_MAX &&
           (out->count < 2 || (double)s->samples < amount->seconds * s->rate)) {
        struct reference_span *span = &out->spans[out->count++];
        size_t to = at + piece_length(c->text + at, c->size - at, amount->least);
        *span = (struct reference_span){at, to, s->samples, 0, s->phone_count, s->word_count};
        if (reference_speak(c->reference, voice, c->text, at, to, s, e))
            return -1;
        span->end = s->samples;
        at = to;
    }
    out->spans[out->count] =
        (struct reference_span){.from = at, .phones = s->phone_count, .words = s->word_count};
    return 0;
}

static int by_time(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Before words, and where the voice pauses. */
uint64_t *long_alignment_pauses(const struct reference_speech *s, size_t *count) {
    uint64_t *starts = mem_alloc((s->word_count + s->phone_count + 1) * sizeof *starts);
    *count = 0;
    for (size_t i = 0; i < s->word_count; i++)
        starts[(*count)++] = s->words[i].start;
    for (size_t i = 0; i + 1 < s->phone_count; i++)
        if (!*s->phones[i].ipa)
            starts[(*count)++] = s->phones[i].end;
    qsort(starts, *count, sizeof *starts, by_time);
    return starts;
}

int long_alignment_find(struct long_alignment *c, struct align_map *map) {
    const struct reference_speech *s = &c->said.speech;
    double seconds = (double)s->samples / s->rate, pace = c->pace > 0 ? c->pace : PACE_FIRST;
    double want = (seconds * pace * WINDOW_FACTOR + WINDOW_MORE) * c->window.source->rate;
    size_t count;
    uint64_t *starts = long_alignment_pauses(s, &count);
    const struct align_options options = {starts, count, true, c->stop};
    int result = -1;
    for (int i = 0; i < TRIES; i++, want *= 1.4) {
        window_fill(&c->window, c->skip + (size_t)want);
        struct align_sound recording = {c->window.pcm + c->skip, c->window.samples - c->skip,
                                        c->window.source->rate};
        bool more = recording.samples > (size_t)want;
        if (more)
            recording.samples = (size_t)want;
        struct align_sound reference = {s->pcm, s->samples, s->rate};
        result = align_make(map, &recording, &reference, &options);
        double end = result ? 1 : (double)align_end_time(map, s->samples) / (double)recording.samples;
        bool all = c->window.ended && !more;
        if (end < 1 - NEAR_END || all || i == TRIES - 1)
            break;
        align_free(map);
    }
    free(starts);
    return result;
}

bool long_alignment_stopped(const struct long_alignment *c) {
    return c->stop && atomic_load(c->stop);
}

int long_alignment_cancelled(struct error *e) {
    return error_set(e, ERROR_CANCELLED, "the alignment was stopped");
}

int long_alignment_misfit(const struct long_alignment *c, size_t byte, double time, const char *why,
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

int long_alignment_choose_voice(struct long_alignment *c, struct error *e) {
    double best = INFINITY;
    const char *chosen = c->voices[0];
    if (c->voice_count == 1) {
        c->chosen = chosen;
        return 0;
    }
    for (size_t i = 0; i < c->voice_count; i++) {
        struct align_map map;
        if (long_alignment_speak(c, &c->said, c->voices[i], &long_alignment_window, e))
            return -1;
        if (!long_alignment_find(c, &map) && map.distance < best) {
            best = map.distance;
            chosen = c->voices[i];
        }
        align_free(&map);
    }
    if (long_alignment_stopped(c))
        return long_alignment_cancelled(e);
    c->chosen = chosen;
    return 0;
}

/* Seconds that the text took, as a multiple of the reference's. */
static double map_pace(const struct long_alignment *c, const struct align_map *map) {
    double took =
        (double)(align_end_time(map, c->said.speech.samples) - align_time(map, 0)) / c->window.source->rate;
    return took / ((double)c->said.speech.samples / c->said.speech.rate);
}

/* Returns the best start, in samples of the window. */
static size_t start_on_grid(struct long_alignment *c, double best, size_t start) {
    best *= BETTER_ON_GRID;
    for (int i = 1; i <= GRID_STARTS; i++) {
        struct align_map map;
        c->skip = (size_t)(i * GRID_SECONDS * c->window.source->rate);
        if (c->skip >= c->window.samples)
            break;
        if (!long_alignment_find(c, &map)) {
            double all = align_apart(&map, 0, c->said.speech.samples);
            if (all < best) {
                best = all;
                start = c->skip;
            }
        }
        align_free(&map);
    }
    return start;
}

/* The text may begin after other sound, such as noise or another voice, and a pause. Then its first words
 * are more distant than the rest, and closer to what follows the pause. */
int long_alignment_choose_start(struct long_alignment *c, struct error *e) {
    uint64_t first = (uint64_t)(FIRST_SECONDS * c->said.speech.rate);
    double best = INFINITY, pace = 0;
    size_t start = 0;
    for (int i = 0; i < STARTS && c->skip != SIZE_MAX; i++) {
        struct align_map map;
        bool good = false;
        if (!long_alignment_find(c, &map)) {
            double all = align_apart(&map, 0, c->said.speech.samples), here = align_apart(&map, 0, first);
            good = !i && here < FIRST_APART * all;
            pace = i ? pace : map_pace(c, &map);
            if (all < BETTER_START * best) {
                best = all;
                start = c->skip;
            }
        }
        align_free(&map);
        c->skip = good ? SIZE_MAX : window_after_pause(&c->window, c->skip);
    }
    if (pace > GRID_PACE)
        start = start_on_grid(c, best, start);
    c->skip = 0;
    window_drop(&c->window, start);
    return long_alignment_stopped(c) ? long_alignment_cancelled(e) : 0;
}

/* ---- results: phones and words of a piece with times and confidence ---- */

/* Shorter pauses (s) belong to the phone before. */
#define PAUSE_LEAST 0.03
#define PHONE_LEAST 0.02
/* Shares of other words' distance at which confidence is 1, and 0 (see align.h). */
#define CERTAIN 0.86
#define WORTHLESS 1.0
/* Seconds for which one moment of a word is held when it is doubtful, and when confidence is 0. */
#define HELD_DOUBTFUL 0.25
#define HELD_WORTHLESS 0.9
/* A word that takes this many times as long as the voice's contains a pause, noise or its neighbours'
 * sounds: the excess counts as held. */
#define DRAWN_OUT 3.0
/* A word is too short to be judged alone: includes its neighbours on both sides. */
enum { BESIDE = 2 };

static double seconds_of(const struct fit *fit, uint64_t at) {
    return (double)window_place(fit->window, fit->base + (size_t)at) / fit->window->source->rate;
}

static uint64_t inside(const struct fit *fit, uint64_t sample) {
    return sample > fit->from ? sample - fit->from : 0;
}

/* s of the recording */
static double fit_time(const struct fit *fit, uint64_t sample) {
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

/* The warp may give a phone no time: it takes some from its longer neighbour. */
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

void long_alignment_refine(struct long_alignment *c, struct fit *fit, const struct reference_span *from,
                           const struct reference_span *to) {
    const struct reference_speech *s = &fit->said->speech;
    struct refine_phone *phones = mem_alloc((to->phones - from->phones + 1) * sizeof *phones);
    size_t count = 0, word = from->words;
    bool pause = false;
    for (size_t i = from->phones; i < to->phones; i++) {
        const struct reference_phone *p = &s->phones[i];
        struct refine_phone *q = &phones[count];
        q->from = align_frame(inside(fit, p->start), s->rate);
        q->to = align_frame(inside(fit, p->end), s->rate);
        q->to = q->to > q->from ? q->to : q->from + 1;
        q->start = align_frame(align_time(fit->map, inside(fit, p->start)), fit->map->measured_speech_rate);
        q->end = align_frame(align_end_time(fit->map, inside(fit, p->end)), fit->map->measured_speech_rate);
        if (count && q->start < q[-1].end)
            q->start = q[-1].end;
        if (q->end < q->start)
            q->end = q->start;
        if (!*p->ipa) {
            pause = true;
            continue;
        }
        memcpy(q->ipa, p->ipa, sizeof q->ipa);
        q->pause = pause;
        pause = false;
        for (; word < to->words && s->words[word].start <= p->start; word++)
            q->word = true;
        count++;
    }
    const struct lip_network *network = reference_network(c->reference);
    struct sound_likelihoods *heard =
        network ? sound_classes_hear(network, fit->window->pcm + fit->base, fit->map->measured_speech_samples,
                                     c->window.source->rate, fit->map->recording.count)
                : NULL;
    bool done = refine(c->model, &fit->map->recording, &fit->map->reference, heard, phones, count, c->stop);
    bool heard_any = heard;
    free(heard);
    if (done) {
        fit->heard = heard_any;
        fit->phones = phones;
        fit->phone_count = count;
    } else {
        free(phones);
    }
}

/* Where the fit has placed a phone of the reference: NULL = only the map knows. */
static const struct refine_phone *placed(const struct fit *fit, uint64_t start) {
    size_t frame = align_frame(inside(fit, start), fit->said->speech.rate), low = 0, high = fit->phone_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (fit->phones[middle].from < frame)
            low = middle + 1;
        else
            high = middle;
    }
    return low < fit->phone_count ? &fit->phones[low] : NULL;
}

/* Time of a boundary before a frame: half a frame before its centre. */
static double frame_time(const struct fit *fit, double frame) {
    frame = fmax(0, frame - 0.5);
    return seconds_of(fit,
                      (uint64_t)llround(frame * FEATURE_HOP / FEATURE_RATE * fit->map->measured_speech_rate));
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
        const struct refine_phone *placed_at = placed(fit, from->start);
        p->start = placed_at ? frame_time(fit, placed_at->begins) : fit_time(fit, from->start);
        p->end = fmax(p->start, placed_at ? frame_time(fit, placed_at->ends) : end_time(fit, from->end));
        p->stress = from->stress;
        memcpy(p->ipa, from->ipa, sizeof p->ipa);
        if (before && p->start - before->end < PAUSE_LEAST)
            before->end = p->start;
        piece->phone_count++;
    }
    for (size_t i = 0; i < piece->phone_count; i++)
        widen(piece, i);
}

/* ---- confidence of a word, where the recogniser has heard the recording: a logistic regression on the
 * development persons of tests/bench/align-truth.mjs, also in noise and with sentences that they do not say,
 * of whether a word begins within 0.1 s of its place ---- */

#define HEARD_ALWAYS 2.52
#define HEARD_DOUBT (-0.42)
#define HEARD_CLASSES 2.17
#define DOUBT_LEAST 1e-4

double long_alignment_heard(const struct fit *fit, uint64_t from, uint64_t to) {
    const struct refine_phone *first = placed(fit, from), *end = fit->phones + fit->phone_count;
    size_t last = align_frame(inside(fit, to), fit->said->speech.rate);
    double sum = 0, count = 0;
    for (const struct refine_phone *p = first; p && p < end && p->from < last; p++, count++)
        sum += (double)p->heard;
    return count > 0 ? sum / count : 0;
}

/* Of a word that begins at `word`, with its neighbours from..to. */
static double heard_confidence(const struct fit *fit, uint64_t from, uint64_t to, uint64_t word) {
    const struct refine_phone *p = placed(fit, word);
    double doubt = log(fmax(p ? 1 - (double)p->sure : 1, DOUBT_LEAST)),
           heard = long_alignment_heard(fit, from, to);
    return 1 / (1 + exp(-(HEARD_ALWAYS + HEARD_DOUBT * doubt + HEARD_CLASSES * heard)));
}

/* ---- and otherwise: its sound and its neighbours', on the piece's scale, and its duration ---- */
/* Confidence of word i, which lasts that many seconds. */
static double word_confidence(const struct fit *fit, const struct reference_span *span, size_t i, double took,
                              const struct long_alignment_piece *piece, double apart) {
    const struct reference_word *words = fit->said->speech.words;
    size_t first = i >= span->words + BESIDE ? i - BESIDE : span->words, last = i + BESIDE + 1;
    uint64_t end = last < span[1].words ? words[last].start : span->end;
    uint64_t own = i + 1 < span[1].words ? words[i + 1].start : span->end;
    double here = apart_of(fit, words[first].start, end);
    double spoken = (double)(own - words[i].start) / fit->said->speech.rate, held = took - DRAWN_OUT * spoken;
    if (!fit->heard)
        held = fmax(align_held(fit->map, inside(fit, words[i].start), inside(fit, own)), held);
    double lasts = fmax(0, fmin(1, (HELD_WORTHLESS - held) / (HELD_WORTHLESS - HELD_DOUBTFUL)));
    if (fit->heard)
        return lasts * heard_confidence(fit, words[first].start, end, words[i].start);
    return lasts *
           (here < 0 || piece->apart <= 0 ? confidence(apart) : confidence(apart * here / piece->apart));
}

static double start_time(const struct fit *fit, uint64_t sample) {
    const struct refine_phone *p = placed(fit, sample);
    return p ? frame_time(fit, p->begins) : fit_time(fit, sample);
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
            .from = from->from, .to = from->to, .start = start_time(fit, from->start)};
        w->end = w->start;
        double next = i + 1 < span[1].words ? start_time(fit, from[1].start) : INFINITY;
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
    if (fit->heard && piece->word_count) {
        piece->confidence = 0;
        for (size_t i = 0; i < piece->word_count; i++)
            piece->confidence += piece->words[i].confidence / (double)piece->word_count;
    }
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
