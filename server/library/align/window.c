/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/window.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Loudness is measured in frames of this length. This many frames of a pause are kept at its start and
 * end, where sounds fade. */
#define FRAME_SECONDS 0.01
enum { KEEP_AFTER = 70, KEEP_BEFORE = 30, FIRST_LOOK = 3000, PAUSE_FRAMES = 50 };
/* As in mfcc.c: silence is below this share of the range from the softest to the loud. */
#define DEPTH_DB 45.0
#define SILENT_SHARE 0.25

static size_t frame_samples(const struct window *w) {
    return (size_t)(FRAME_SECONDS * w->source->rate);
}

static int level_of(const int16_t *pcm, size_t count) {
    double energy = 1;
    for (size_t i = 0; i < count; i++)
        energy += (double)pcm[i] * pcm[i];
    int level = (int)(10 * log10(energy / (double)(count ? count : 1)));
    return level < 0 ? 0 : level >= WINDOW_LEVELS ? WINDOW_LEVELS - 1 : level;
}

static int quantile(const struct window *w, double share) {
    uint64_t all = 0, sum = 0;
    int level = 0;
    for (int i = 0; i < WINDOW_LEVELS; i++)
        all += w->levels[i];
    while (level < WINDOW_LEVELS - 1 && (sum += w->levels[level]) <= share * (double)all)
        level++;
    return level;
}

static double silence_level(const struct window *w) {
    double loud = quantile(w, 0.95), soft = fmax(quantile(w, 0.02), loud - DEPTH_DB);
    return soft + SILENT_SHARE * (loud - soft);
}

/* Reads a frame at that sample of the recording; returns its length and whether it is silent. */
static size_t look(struct window *w, uint64_t at, double silence, int16_t *out, bool *silent) {
    size_t count = w->source->read(w->source->ctx, at, out, frame_samples(w));
    int level = level_of(out, count);
    if (count && at >= w->judged) {
        w->levels[level]++;
        w->judged = at + count;
    }
    *silent = level < silence;
    return count;
}

void window_open(struct window *w, const struct sound_source *source) {
    *w = (struct window){.source = source};
    int16_t *frame = mem_alloc(frame_samples(w) * sizeof *frame);
    bool silent;
    for (int i = 0; i < FIRST_LOOK && look(w, w->judged, 0, frame, &silent); i++)
        ;
    free(frame);
}

void window_close(struct window *w) {
    free(w->pcm);
    free(w->pieces);
    *w = (struct window){0};
}

struct window window_copy(const struct window *w) {
    struct window copy = *w;
    copy.pcm = mem_alloc((w->cap ? w->cap : 1) * sizeof *copy.pcm);
    copy.pieces = mem_alloc((w->piece_cap ? w->piece_cap : 1) * sizeof *copy.pieces);
    if (w->samples)
        memcpy(copy.pcm, w->pcm, w->samples * sizeof *copy.pcm);
    if (w->piece_count)
        memcpy(copy.pieces, w->pieces, w->piece_count * sizeof *copy.pieces);
    return copy;
}

static void add_piece(struct window *w, uint64_t there) {
    w->pieces = mem_grow(w->pieces, &w->piece_cap, w->piece_count + 1, sizeof *w->pieces);
    w->pieces[w->piece_count++] = (struct window_piece){w->samples, there};
}

/* Skips the middle of a long silence. */
static void leap(struct window *w, double silence) {
    size_t length = frame_samples(w), count = length;
    int16_t *frame = mem_alloc(length * sizeof *frame);
    uint64_t at = w->next, keep = (uint64_t)KEEP_BEFORE * length;
    bool silent = true;
    while ((count = look(w, at, silence, frame, &silent)) == length && silent)
        at += count;
    free(frame);
    if (silent) { /* up to the recording's end */
        w->next = at + count;
    } else if (at - w->next > keep) {
        w->next = at - keep;
        add_piece(w, w->next);
    }
    w->silent = 0;
}

void window_fill(struct window *w, size_t samples) {
    size_t length = frame_samples(w);
    double silence = silence_level(w);
    if (!w->piece_count)
        add_piece(w, w->next);
    while (w->samples < samples && !w->ended) {
        bool silent;
        w->pcm = mem_grow(w->pcm, &w->cap, w->samples + length, sizeof *w->pcm);
        size_t count = look(w, w->next, silence, w->pcm + w->samples, &silent);
        w->samples += count;
        w->next += count;
        w->ended = count < length;
        w->silent = silent ? w->silent + 1 : 0;
        if (w->silent >= KEEP_AFTER + KEEP_BEFORE)
            leap(w, silence);
    }
}

void window_drop(struct window *w, size_t sample) {
    size_t first = 0;
    if (sample > w->samples)
        sample = w->samples;
    while (first + 1 < w->piece_count && w->pieces[first + 1].here <= sample)
        first++;
    if (!w->piece_count)
        return;
    w->pieces[first].there += sample - w->pieces[first].here;
    w->pieces[first].here = sample;
    w->piece_count -= first;
    memmove(w->pieces, w->pieces + first, w->piece_count * sizeof *w->pieces);
    for (size_t i = 0; i < w->piece_count; i++)
        w->pieces[i].here -= sample;
    w->samples -= sample;
    memmove(w->pcm, w->pcm + sample, w->samples * sizeof *w->pcm);
}

uint64_t window_place(const struct window *w, size_t sample) {
    size_t i = 0;
    if (!w->piece_count)
        return w->next;
    while (i + 1 < w->piece_count && w->pieces[i + 1].here <= sample)
        i++;
    return w->pieces[i].there + (sample - w->pieces[i].here);
}

size_t window_after_pause(const struct window *w, size_t from) {
    double silence = silence_level(w);
    size_t length = frame_samples(w), run = 0;
    for (size_t at = from; at + length <= w->samples; at += length) {
        bool silent = level_of(w->pcm + at, length) < silence;
        if (!silent && run >= PAUSE_FRAMES)
            return at;
        run = silent ? run + 1 : 0;
    }
    return SIZE_MAX;
}

double window_sounds(struct window *w, uint64_t from, uint64_t to, double enough) {
    double silence = silence_level(w), sounding = 0;
    int16_t *frame = mem_alloc(frame_samples(w) * sizeof *frame);
    bool silent;
    for (size_t count; from < to && sounding < enough && (count = look(w, from, silence, frame, &silent));
         from += count)
        sounding += silent ? 0 : FRAME_SECONDS;
    free(frame);
    return sounding;
}
