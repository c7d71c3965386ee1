/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a long alignment looks for, and where. */
#include "server/align/long_alignment_internal.h"
#include "server/base/mem.h"
#include "server/markup/plain.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* So much synthetic speech is looked for at once, at least two pieces; they are not cut where they would be
 * shorter than the least. */
const struct speak_amount long_alignment_window = {20, 40};
/* A piece is at most so long, bytes (about 13 s). */
enum { PIECE_BYTES = 200, TRIES = 3 };
/* Seconds of the recording for each of the reference: what people need at most, until it is known. */
#define PACE_FIRST 1.7
/* The window is longer than what is expected by this factor, and by so many seconds. */
#define WINDOW_FACTOR 1.35
#define WINDOW_MORE 3.0
/* A way that ends within this share of the window's end may have been cut off by it. */
#define NEAR_END 0.03
/* The beginning: so many places are tried, if the first words (s) are so much farther than the others are;
 * each must be so much better than the ones before. */
#define FIRST_SECONDS 1.0
#define FIRST_APART 1.05
#define BETTER_START 0.98
enum { STARTS = 5 };

/* The length of the piece at the head of the text: a sentence, or what stands before a comma or a space in
 * one that is too long. */
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

/* The text may begin after something else, such as noise or another voice, and a pause: then its first words
 * are farther from what is heard first than the others are from theirs, and nearer to what follows the pause.
 */
int long_alignment_choose_start(struct long_alignment *c, struct error *e) {
    uint64_t first = (uint64_t)(FIRST_SECONDS * c->said.speech.rate);
    double best = INFINITY;
    size_t start = 0;
    for (int i = 0; i < STARTS && c->skip != SIZE_MAX; i++) {
        struct align_map map;
        bool good = false;
        if (!long_alignment_find(c, &map)) {
            double all = align_apart(&map, 0, c->said.speech.samples), here = align_apart(&map, 0, first);
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
    return long_alignment_stopped(c) ? long_alignment_cancelled(e) : 0;
}
