/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is done where text and recording differ. */
#include "server/align/long_alignment_internal.h"
#include "server/align/piece_search.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* So much of the text is looked for at once, by sentences, in what it would take and so many seconds more;
 * then in what follows, which begins so many seconds before the end of that, so often. */
static const struct speak_amount block_amount = {40, 14};
#define AHEAD_SECONDS 60.0
#define OVERLAP_SECONDS 25.0
enum { LOOKS = 8 };
#define PACE_FIRST 1.2
/* A reader who is so much slower than the voice that it is aligned to is not found at its pace. */
static const double paces[] = {1, 1.35, 1.8};
/* Pieces that follow one another are believed if together they are nearer by so much than what is not of the
 * text. */
#define TRUST 25.0f
/* So many seconds on both sides of what was found are aligned with it. */
#define MARGIN 0.3
/* What ends so near to the end of what was looked at may go on. */
#define CUT_SECONDS 1.0
/* Of a text of which nothing has been found, so many bytes are tried. */
enum { TRIED_BYTES = 2500 };

/* A block of text, and what was found of it. */
struct block {
    struct spoken said;
    struct window window;
    struct piece_place places[PIECES_MAX];
    size_t last; /* piece that counts; said.count = none */
    double gain;
    const char *voice;
};

static size_t sample_of(const struct block *b, size_t frame) {
    size_t sample = (size_t)((double)frame * FEATURE_HOP / FEATURE_RATE * b->window.source->rate);
    return sample < b->window.samples ? sample : b->window.samples;
}

/* Only runs of pieces that together are trusted stay, and not what the window's end may have cut. */
static void judge(struct block *b) {
    size_t end = b->said.count, cut = b->window.samples - (size_t)(CUT_SECONDS * b->window.source->rate);
    b->last = end;
    b->gain = 0;
    for (size_t k = 0; k < end;) {
        float gain = 0;
        size_t to = k;
        do
            gain += b->places[to].gain;
        while (++to < end && b->places[to].found && b->places[to].follows);
        for (size_t i = k; i < to; i++)
            b->places[i].found = b->places[i].found && gain >= TRUST;
        if (gain >= TRUST) {
            b->last = to - 1;
            b->gain += (double)gain;
        }
        k = to;
    }
    if (b->last < end && !b->window.ended && sample_of(b, b->places[b->last].end) > cut) {
        b->places[b->last].found = false;
        do
            b->last = b->last ? b->last - 1 : end;
        while (b->last < end && !b->places[b->last].found);
    }
}

static int search(const struct long_alignment *c, struct block *b) {
    struct features recording, reference;
    struct piece_frames frames[PIECES_MAX];
    struct piece_place places[PIECES_MAX];
    size_t which[PIECES_MAX], count = 0;
    const struct reference_speech *s = &b->said.speech;
    features_make(&recording, b->window.pcm, b->window.samples, b->window.source->rate);
    features_make(&reference, s->pcm, s->samples, s->rate);
    for (size_t k = 0; k < b->said.count; k++) {
        const struct reference_span *span = &b->said.spans[k];
        b->places[k] = (struct piece_place){.found = false};
        if (span[1].words == span->words)
            continue;
        which[count] = k;
        frames[count++] =
            (struct piece_frames){(size_t)((double)span->start * FEATURE_RATE / s->rate / FEATURE_HOP),
                                  (size_t)((double)span->end * FEATURE_RATE / s->rate / FEATURE_HOP)};
    }
    int result = 0;
    bool all = false;
    for (size_t p = 0; p < sizeof paces / sizeof *paces && !result && !all; p++) {
        struct piece_search how = {&recording, &reference, frames, count, paces[p], c->stop};
        struct block best = *b; /* of the paces before */
        result = piece_search(&how, places);
        for (size_t i = 0; i < count; i++)
            b->places[which[i]] = places[i];
        judge(b);
        all = true;
        for (size_t i = 0; i < count; i++)
            all = all && b->places[which[i]].found;
        if (p && best.gain >= b->gain) {
            memcpy(b->places, best.places, sizeof b->places);
            b->last = best.last;
            b->gain = best.gain;
        }
    }
    features_free(&recording);
    features_free(&reference);
    return result;
}

/* Looks for the block of one voice, on and on. -1 with *e; what was found is in b. */
static int look(struct long_alignment *c, struct block *b, struct error *e) {
    double rate = c->window.source->rate, pace = c->pace > 0 ? c->pace : PACE_FIRST;
    b->window = window_copy(&c->window);
    b->last = b->said.count;
    if (long_alignment_speak(c, &b->said, b->voice, &block_amount, e))
        return -1;
    double seconds = (double)b->said.speech.samples / (b->said.speech.rate ? b->said.speech.rate : 1);
    for (int i = 0; i < LOOKS; i++) {
        window_fill(&b->window, (size_t)((seconds * pace + AHEAD_SECONDS) * rate));
        if (search(c, b))
            return long_alignment_cancelled(e);
        if (b->last < b->said.count || b->window.ended)
            return 0;
        window_drop(&b->window, b->window.samples - (size_t)(OVERLAP_SECONDS * rate));
    }
    return 0;
}

/* Is all up to that byte there, from the beginning of the window on? */
static bool whole(const struct block *b, size_t until) {
    bool first = true;
    for (size_t k = 0; k < b->said.count && b->said.spans[k].to <= until; k++) {
        if (b->said.spans[k + 1].words == b->said.spans[k].words)
            continue;
        if (!b->places[k].found || !b->places[k].follows)
            return false;
        first = false;
    }
    return !first;
}

/* The pieces from..to follow one another: aligned as exactly as any. */
static void take_run(struct long_alignment *c, struct block *b, size_t from, size_t to) {
    const struct reference_speech *s = &b->said.speech;
    const struct reference_span *spans = b->said.spans;
    size_t margin = (size_t)(MARGIN * b->window.source->rate), count, used = 0;
    size_t begin = sample_of(b, b->places[from].begin), end = sample_of(b, b->places[to - 1].end) + margin;
    begin = begin > margin ? begin - margin : 0;
    end = end < b->window.samples ? end : b->window.samples;
    uint64_t *starts = long_alignment_pauses(s, &count), first = spans[from].start;
    for (size_t i = 0; i < count; i++)
        if (starts[i] >= first && starts[i] < spans[to - 1].end)
            starts[used++] = starts[i] - first;
    const struct align_sound recording = {b->window.pcm + begin, end - begin, b->window.source->rate};
    const struct align_sound reference = {s->pcm + first, (size_t)(spans[to - 1].end - first), s->rate};
    const struct align_options options = {starts, used, true, c->stop};
    struct align_map map;
    bool well = !align_make(&map, &recording, &reference, &options);
    const struct fit fit = {&map, &b->window, &b->said, first, begin};
    double until = c->until;
    size_t first_ready = c->ready_count;
    for (size_t k = from; k < to; k++)
        if (well)
            long_alignment_take(c, &fit, &spans[k], (double)b->places[k].apart);
        else
            long_alignment_miss(c, &spans[k]);
    struct long_alignment_piece *piece = &c->ready[first_ready];
    double rate = b->window.source->rate;
    if (well && piece->start > until)
        piece->passed = window_sounds(&b->window, (uint64_t)(until * rate), (uint64_t)(piece->start * rate),
                                      piece->start - until);
    align_free(&map);
    free(starts);
}

static void take_block(struct long_alignment *c, struct block *b) {
    for (size_t k = 0, to; k <= b->last; k = to) {
        to = k + 1;
        if (!b->places[k].found) {
            if (b->said.spans[to].words > b->said.spans[k].words)
                long_alignment_miss(c, &b->said.spans[k]);
            continue;
        }
        while (to <= b->last && b->places[to].found && b->places[to].follows)
            to++;
        take_run(c, b, k, to);
    }
    size_t end = sample_of(b, b->places[b->last].end);
    c->at = b->said.spans[b->last + 1].from;
    c->chosen = b->voice;
    c->lost = false;
    window_close(&c->window);
    c->window = b->window;
    b->window = (struct window){0};
    window_drop(&c->window, end);
}

/* Nothing of the block was found: half of it, or the rest of the text, is not in the recording. */
static int pass_over(struct long_alignment *c, const struct block *b, struct error *e) {
    size_t count = b->said.spans[b->said.count].from == c->size ? b->said.count : (b->said.count + 1) / 2;
    c->lost = true;
    for (size_t k = 0; k < count; k++)
        if (b->said.spans[k + 1].words > b->said.spans[k].words)
            long_alignment_miss(c, &b->said.spans[k]);
    c->at = b->said.spans[count].from;
    if (c->found || (c->at < TRIED_BYTES && c->at < c->size))
        return 1;
    double here = (double)window_place(&c->window, 0) / c->window.source->rate;
    long_alignment_misfit(c, 0, here, "the words are not those of the recording", &c->failure);
    c->failed = true;
    *e = c->failure;
    return -1;
}

int long_alignment_recover(struct long_alignment *c, size_t until, struct error *e) {
    struct block *best = NULL;
    int result = 0;
    for (size_t i = 0; i < c->voice_count && !result; i++) {
        struct block *b = mem_alloc(sizeof *b);
        b->voice = c->found ? c->chosen : c->voices[i];
        result = look(c, b, e);
        bool better =
            !best || (b->last < b->said.count && (best->last == best->said.count || b->gain > best->gain));
        struct block *worse = better ? best : b;
        best = better ? b : best;
        if (worse) {
            window_close(&worse->window);
            reference_free(&worse->said.speech);
            free(worse);
        }
        if (c->found)
            break;
    }
    if (!result && best->last == best->said.count) {
        result = pass_over(c, best, e);
    } else if (!result && !(best->voice == c->chosen && whole(best, until))) {
        take_block(c, best);
        result = 1;
    }
    window_close(&best->window);
    reference_free(&best->said.speech);
    free(best);
    return result;
}
