/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/chapter.h"
#include "server/align/align.h"
#include "server/align/chance.h"
#include "server/align/window.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/markup/plain.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* So much synthetic speech is looked for at once, s; at least two pieces. */
#define REFERENCE_SECONDS 20.0
/* A piece is at most so long, bytes (about 13 s), and not cut where it would be shorter than the least. */
enum { PIECE_BYTES = 200, PIECE_BYTES_LEAST = 40, PIECES_MAX = 64, TRIES = 3 };
/* Seconds of the recording for each of the reference: what people need at most, until it is known. */
#define PACE_FIRST 1.7
/* The window is longer than what is expected by this factor, and by so many seconds. */
#define WINDOW_FACTOR 1.35
#define WINDOW_MORE 3.0
/* A way that ends within this share of the window's end may have been cut off by it. */
#define NEAR_END 0.03
/* Pauses between phones that are shorter than this belong to the phone before, s. */
#define PAUSE_LEAST 0.03
#define REST_ENOUGH 60.0
/* The beginning: so many places are tried, if the first words (s) are so much farther than the others are;
 * each must be so much better than the ones before. */
#define FIRST_SECONDS 1.0
#define FIRST_APART 1.05
#define BETTER_START 0.98
enum { STARTS = 5 };

struct span {
    size_t from, to;      /* bytes of the text */
    uint64_t start, end;  /* samples of the reference */
    size_t phones, words; /* the first of each */
};

struct chapter {
    struct window window;
    struct reference *reference;
    const char *text;
    size_t size, at; /* the text that is to come */
    const atomic_bool *stop;
    const char *voices[2];
    size_t voice_count;
    double pace; /* 0 = not known yet */
    size_t skip; /* samples of the window that are passed over */
    struct reference_speech speech;
    struct span spans[PIECES_MAX + 1];
    size_t span_count;
    struct chapter_piece *ready; /* found and not yet handed out */
    size_t ready_count, ready_at, ready_cap;
};

void chapter_piece_free(struct chapter_piece *piece) {
    free(piece->phones);
    free(piece->words);
    *piece = (struct chapter_piece){0};
}

struct chapter *chapter_open(const struct sound_source *source, struct reference *reference, const char *text,
                             size_t size, const struct chapter_options *options, struct error *e) {
    static const char *const genders[] = {"male", "female"};
    struct chapter *c = mem_alloc(sizeof *c);
    c->reference = reference;
    c->text = text;
    c->size = size;
    c->stop = options->stop;
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
    error_set(e, "no-reference", "no voice to align to speaks '%.40s'", options->lang);
    chapter_free(c);
    return NULL;
}

void chapter_free(struct chapter *c) {
    if (!c)
        return;
    for (; c->ready_at < c->ready_count; c->ready_at++)
        chapter_piece_free(&c->ready[c->ready_at]);
    free(c->ready);
    window_close(&c->window);
    reference_free(&c->speech);
    free(c);
}

/* The length of the piece at the head of the text: a sentence, or what stands before a comma or a space in
 * one that is too long. */
static size_t piece_length(const char *text, size_t size) {
    size_t length = plain_sentence(text, size, NULL), comma = 0, space = 0;
    while (length < PIECE_BYTES_LEAST && length < size)
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

/* Has the voice speak pieces of the text from there on, until there are enough. Returns where they end. */
static int speak(struct chapter *c, const char *voice, struct error *e) {
    struct reference_speech *s = &c->speech;
    size_t at = c->at;
    reference_clear(s);
    c->span_count = 0;
    while (at < c->size && c->span_count < PIECES_MAX &&
           (c->span_count < 2 || (double)s->samples < REFERENCE_SECONDS * s->rate)) {
        struct span *span = &c->spans[c->span_count++];
        size_t to = at + piece_length(c->text + at, c->size - at);
        *span = (struct span){at, to, s->samples, 0, s->phone_count, s->word_count};
        if (reference_speak(c->reference, voice, c->text, at, to, s, e))
            return -1;
        span->end = s->samples;
        at = to;
    }
    c->spans[c->span_count] = (struct span){.from = at, .phones = s->phone_count, .words = s->word_count};
    return 0;
}

static bool to_the_end(const struct chapter *c) {
    return c->spans[c->span_count].from == c->size;
}

static int by_time(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Where the speaker may pause: before words, and where the voice does. */
static uint64_t *pauses(const struct reference_speech *s, size_t *count) {
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

/* Looks for what the voice has spoken in the window, which is made longer if need be. -1 when the recording
 * is far too short. */
static int find(struct chapter *c, struct align_map *map) {
    const struct reference_speech *s = &c->speech;
    double seconds = (double)s->samples / s->rate, pace = c->pace > 0 ? c->pace : PACE_FIRST;
    double want = (seconds * pace * WINDOW_FACTOR + WINDOW_MORE) * c->window.source->rate;
    size_t count;
    uint64_t *starts = pauses(s, &count);
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

/* Time of a sample of the window. */
static double seconds_of(const struct chapter *c, uint64_t sample) {
    return (double)window_place(&c->window, (size_t)sample) / c->window.source->rate;
}

static void take_phones(const struct chapter *c, const struct align_map *map, const struct span *span,
                        struct chapter_piece *piece) {
    piece->phones = mem_alloc((span[1].phones - span->phones + 1) * sizeof *piece->phones);
    for (size_t i = span->phones; i < span[1].phones; i++) {
        const struct reference_phone *from = &c->speech.phones[i];
        struct chapter_phone *p = &piece->phones[piece->phone_count];
        struct chapter_phone *before = piece->phone_count ? p - 1 : NULL;
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
}

/* A word ends with its last phone. */
static void take_words(const struct chapter *c, const struct align_map *map, const struct span *span,
                       struct chapter_piece *piece) {
    size_t phone = 0;
    piece->words = mem_alloc((span[1].words - span->words + 1) * sizeof *piece->words);
    for (size_t i = span->words; i < span[1].words; i++) {
        const struct reference_word *from = &c->speech.words[i];
        struct chapter_word *w = &piece->words[piece->word_count++];
        *w = (struct chapter_word){from->from, from->to, seconds_of(c, align_time(map, from->start)), 0};
        w->end = w->start;
        double next = i + 1 < span[1].words ? seconds_of(c, align_time(map, from[1].start)) : INFINITY;
        for (; phone < piece->phone_count && piece->phones[phone].start < next - 1e-9; phone++)
            w->end = fmax(w->end, piece->phones[phone].end);
        w->end = fmin(w->end, fmax(w->start, next));
    }
}

static void take(struct chapter *c, const struct align_map *map, const struct span *span) {
    c->ready = mem_grow(c->ready, &c->ready_cap, c->ready_count + 1, sizeof *c->ready);
    struct chapter_piece *piece = &c->ready[c->ready_count++];
    *piece = (struct chapter_piece){.from = span->from, .to = span->to};
    take_phones(c, map, span, piece);
    take_words(c, map, span, piece);
    piece->apart = align_apart(map, span->start, span->end);
    piece->start = piece->end = seconds_of(c, align_time(map, span->start));
    if (piece->phone_count) {
        piece->start = piece->phones[0].start;
        piece->end = piece->phones[piece->phone_count - 1].end;
    }
}

static int misfit(const struct chapter *c, size_t byte, double time, const char *why, struct error *e) {
    size_t line = 1, column = 1;
    for (size_t i = 0; i < byte; i++) {
        column += (c->text[i] & 0xC0) != 0x80;
        if (c->text[i] == '\n') {
            line++;
            column = 1;
        }
    }
    int minutes = (int)(time / 60);
    return error_at_line(e, "misaligned", line, column, "%s, at %d:%04.1f of the recording", why, minutes,
                         time - 60.0 * minutes);
}

static bool stopped(const struct chapter *c) {
    return c->stop && atomic_load(c->stop);
}

static int cancelled(struct error *e) {
    return error_set(e, "cancelled", "the alignment was stopped");
}

/* The voice that comes closest, by what it makes of the first window. */
static int choose_voice(struct chapter *c, struct error *e) {
    double best = INFINITY;
    const char *chosen = c->voices[0];
    for (size_t i = 0; i < c->voice_count; i++) {
        struct align_map map;
        if (speak(c, c->voices[i], e))
            return -1;
        if (!find(c, &map) && map.distance < best) {
            best = map.distance;
            chosen = c->voices[i];
        }
        align_free(&map);
    }
    if (stopped(c))
        return cancelled(e);
    c->voices[0] = chosen;
    c->voice_count = 1;
    return 0;
}

/* The text may begin after something else, such as noise or another voice, and a pause: then its first words
 * are farther from what is heard first than the others are from theirs, and nearer to what follows the pause.
 */
static int choose_start(struct chapter *c, struct error *e) {
    uint64_t first = (uint64_t)(FIRST_SECONDS * c->speech.rate);
    double best = INFINITY;
    size_t start = 0;
    for (int i = 0; i < STARTS && c->skip != SIZE_MAX; i++) {
        struct align_map map;
        bool good = false;
        if (!find(c, &map)) {
            double all = align_apart(&map, 0, c->speech.samples), here = align_apart(&map, 0, first);
            good = !i && here < FIRST_APART * all;
            if (all < BETTER_START * best) {
                best = all;
                start = c->skip;
            }
        }
        align_free(&map);
        c->skip = good ? SIZE_MAX : window_after_pause(&c->window, c->skip);
    }
    c->skip = 0;
    window_drop(&c->window, start);
    return stopped(c) ? cancelled(e) : 0;
}

/* Are these the words of the recording? */
static int check(const struct chapter *c, const struct align_map *map, size_t count, struct error *e) {
    const struct align_sound recording = {c->window.pcm, map->recording_samples, c->window.source->rate};
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
static int advance(struct chapter *c, struct error *e) {
    struct align_map map;
    double here = seconds_of(c, 0);
    bool begins = !c->at && !c->pace;
    if (c->voice_count > 1 && choose_voice(c, e))
        return -1;
    if (speak(c, c->voices[0], e) || (begins && c->speech.word_count && choose_start(c, e)))
        return -1;
    if (!c->speech.word_count) { /* nothing to be said in it */
        c->at = c->spans[c->span_count].from;
        return 0;
    }
    if (find(c, &map)) {
        align_free(&map);
        return stopped(c) ? cancelled(e) : misfit(c, c->at, here, "the recording ends before the text", e);
    }
    size_t count = to_the_end(c) ? c->span_count : c->span_count - 1;
    int result = check(c, &map, count, e);
    if (stopped(c))
        result = cancelled(e);
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

int chapter_next(struct chapter *c, struct chapter_piece *piece, struct error *e) {
    while (c->ready_at == c->ready_count) {
        if (c->at == c->size)
            return 0;
        if (advance(c, e))
            return -1;
    }
    *piece = c->ready[c->ready_at];
    c->ready[c->ready_at++] = (struct chapter_piece){0};
    return 1;
}

double chapter_rest(struct chapter *c) {
    return window_rest(&c->window, window_place(&c->window, 0), REST_ENOUGH);
}
