/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/align/chance_distance.h"
#include "server/align/long_alignment_internal.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REST_ENOUGH 60.0
/* Signs that a window is not what the text says, each of which is looked into: a piece is so far off, a share
 * of other words; it takes so much less or more time than the others; so many seconds are heard that are none
 * of it. */
#define PIECE_SHARE 0.975
#define SHORT_SHARE 0.6
#define LONG_SHARE 1.75
#define PASSED_SECONDS 0.6
#define JUDGED_SECONDS 1.0

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
    reference_free(&c->said.speech);
    free(c);
}

/* Do the pieces seem to be what is read there? */
static bool fits(struct long_alignment *c, const struct align_map *map, size_t count) {
    const struct align_sound recording = {c->window.pcm, map->measured_speech_samples,
                                          c->window.source->rate};
    const struct reference_span *spans = c->said.spans;
    double apart, other = chance(&recording, &c->said.speech, map, c->stop, &apart);
    c->likely = other <= 0 || apart < CHANCE_SHARE * other;
    if (!c->likely)
        return false;
    if (other > 0)
        c->other = other;
    double all = (double)(align_end_time(map, spans[count - 1].end) - align_time(map, 0)) /
                 (double)spans[count - 1].end;
    for (size_t i = 0; i < count; i++) {
        double spoken = (double)(spans[i].end - spans[i].start);
        double took = (double)(align_end_time(map, spans[i].end) - align_time(map, spans[i].start));
        if (spoken < JUDGED_SECONDS * c->said.speech.rate)
            continue;
        if (took < SHORT_SHARE * all * spoken || took > LONG_SHARE * all * spoken ||
            (c->other > 0 && align_apart(map, spans[i].start, spans[i].end) > PIECE_SHARE * c->other) ||
            align_passed(map, spans[i ? i - 1 : 0].start, spans[i].end) > PASSED_SECONDS)
            return false;
    }
    return true;
}

static void take_all(struct long_alignment *c, const struct align_map *map, size_t count) {
    const struct fit fit = {map, &c->window, &c->said, 0, 0};
    const struct reference_span *spans = c->said.spans;
    uint64_t begin = align_time(map, 0), end = align_end_time(map, spans[count - 1].end);
    for (size_t i = 0; i < count; i++) {
        double apart = align_apart(map, spans[i].start, spans[i].end);
        long_alignment_take(c, &fit, &spans[i], c->other > 0 && apart >= 0 ? apart / c->other : 0);
    }
    if (end > begin)
        c->pace = (double)(end - begin) / c->window.source->rate /
                  ((double)spans[count - 1].end / c->said.speech.rate);
    window_drop(&c->window, (size_t)end);
    c->at = spans[count].from;
}

/* Aligns the next pieces, if they follow what was aligned last: 1, or 0 when they seem not to, -1 with *e. */
static int follow(struct long_alignment *c, struct error *e) {
    struct align_map map;
    bool begins = !c->at && !c->pace;
    if ((!c->chosen && long_alignment_choose_voice(c, e)) ||
        long_alignment_speak(c, &c->said, c->chosen, &long_alignment_window, e) ||
        (begins && c->said.speech.word_count && long_alignment_choose_start(c, e)))
        return -1;
    size_t count = c->said.count, to = c->said.spans[count].from;
    if (!c->said.speech.word_count) { /* nothing to be said in it */
        c->at = to;
        return 1;
    }
    count -= to < c->size; /* the last one may go on into what is not in the window */
    int result = long_alignment_find(c, &map) ? 0 : 1;
    if (result && !c->made && !fits(c, &map, count)) {
        result = long_alignment_stopped(c) ? 0 : long_alignment_recover(c, c->said.spans[count].from, e);
        if ((c->failed || (c->lost && result > 0)) && c->likely) {
            /* all in all they are the words: too few of them to be told apart, or read too slowly */
            c->failed = c->lost = false;
            c->at = c->said.spans[0].from;
            c->ready_count = 0;
            result = 0;
        }
        if (result) { /* it has gone on, or failed */
            align_free(&map);
            return result;
        }
        result = 1;
    }
    if (long_alignment_stopped(c))
        result = long_alignment_cancelled(e);
    if (result > 0)
        take_all(c, &map, count);
    align_free(&map);
    return result;
}

static int advance(struct long_alignment *c, struct error *e) {
    double here = (double)window_place(&c->window, 0) / c->window.source->rate;
    if (c->failed) {
        *e = c->failure;
        return -1;
    }
    c->ready_at = c->ready_count = 0;
    int result = c->lost ? 0 : follow(c, e);
    if (result)
        return result < 0 ? -1 : 0;
    if (c->made)
        return long_alignment_misfit(c, c->at, here, "the recording ends before the text", e);
    return long_alignment_recover(c, 0, e) < 0 ? -1 : 0;
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
    return window_sounds(&c->window, window_place(&c->window, 0), UINT64_MAX, REST_ENOUGH);
}
