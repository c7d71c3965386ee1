/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/kokoro/kokoro_internal.h"
#include <math.h>

enum { WINDOW = KO_RATE / 100 };

/* RMS relative to the loudest window below which sound is quiet (-40 dB) or silent (-52 dB). */
#define QUIET 0.01
#define NOTHING 0.0025

/* Minimum pause between words; a shorter gap may be a stop's closure. */
#define PAUSE_MIN (KO_RATE * 6 / 100)

static double level(const int16_t *samples, uint32_t from, uint32_t to) {
    double sum = 0;
    for (uint32_t i = from; i < to; i++)
        sum += (double)samples[i] * samples[i];
    return to > from ? sqrt(sum / (to - from)) : 0;
}

static double loudest(const int16_t *samples, uint32_t count) {
    double most = 0;
    for (uint32_t i = 0; i + WINDOW <= count; i += WINDOW)
        most = fmax(most, level(samples, i, i + WINDOW));
    return most;
}

/* Sets [from, to) to the sound without surrounding silence. */
static void trim(struct ko_timing *t, const int16_t *samples, uint32_t count, double limit) {
    uint32_t from = 0, to = count;
    while (from + WINDOW <= to && level(samples, from, from + WINDOW) <= limit)
        from += WINDOW;
    while (to >= from + WINDOW && level(samples, to - WINDOW, to) <= limit)
        to -= WINDOW;
    t->from = from > KO_MARGIN ? from - KO_MARGIN : 0;
    t->to = count - to > KO_MARGIN ? to + KO_MARGIN : count;
}

static uint32_t shifted(uint32_t units) {
    uint32_t at = units * KO_UNIT;
    return at > KO_SHIFT ? at - KO_SHIFT : 0;
}

static struct ko_span *add(struct ko_timing *t, size_t item, uint32_t start, uint32_t end) {
    t->list = mem_grow(t->list, &t->cap, t->count + 1, sizeof *t->list);
    t->list[t->count] = (struct ko_span){item, start, end};
    return &t->list[t->count++];
}

/* Returns where the quiet stretch that ends at `end` begins, not before floor. */
static uint32_t quiet_from(const int16_t *samples, uint32_t floor, uint32_t end, double limit) {
    while (end >= floor + WINDOW && level(samples, end - WINDOW, end) <= limit)
        end -= WINDOW;
    return end;
}

/* Handles a gap between words. A phone's duration extends into the following silence, so the pause begins
 * where the sound ends. Returns where the next phone begins. */
static uint32_t add_gap(struct ko_timing *t, const int16_t *samples, uint32_t start, uint32_t end,
                        double limit) {
    struct ko_span *before = t->count ? &t->list[t->count - 1] : NULL;
    if (!before || before->item == SIZE_MAX)
        return end;
    uint32_t floor = before->start + KO_UNIT < start ? before->start + KO_UNIT : start;
    uint32_t quiet = quiet_from(samples, floor, end, limit);
    if (end - quiet < PAUSE_MIN)
        return before->end = start + (end - start) / 2;
    before->end = quiet;
    add(t, SIZE_MAX, quiet, end);
    return end;
}

/* Makes spans in samples of the whole piece. */
static void lay_out(struct ko_timing *t, const struct ko_item *items, size_t count, const uint16_t *durations,
                    const int16_t *samples, uint32_t sample_count, double limit) {
    uint32_t units = durations[0], begin = shifted(units), end = begin;
    for (size_t i = 0, token = 1; i < count; i++) {
        for (unsigned k = 0; k < items[i].token_count; k++)
            units += durations[token++];
        end = shifted(units) < sample_count ? shifted(units) : sample_count;
        begin = begin < end ? begin : end;
        if (items[i].kind == KO_PHONE) {
            add(t, i, begin, end);
            begin = end;
        } else {
            begin = add_gap(t, samples, begin, end, limit);
        }
    }
    if (t->count && t->list[t->count - 1].item == SIZE_MAX)
        t->count--; /* the end is a pause anyway */
    else if (t->count)
        t->list[t->count - 1].end = end;
}

void ko_time(struct ko_timing *timing, const struct ko_item *items, size_t count, const uint16_t *durations,
             const int16_t *samples, uint32_t sample_count) {
    double most = loudest(samples, sample_count);
    timing->count = 0;
    trim(timing, samples, sample_count, most * NOTHING);
    lay_out(timing, items, count, durations, samples, sample_count, most * QUIET);
    struct ko_span *list = timing->list;
    if (!timing->count) {
        add(timing, SIZE_MAX, 0, timing->to - timing->from);
        return;
    }
    if (list[0].start < timing->from)
        timing->from = list[0].start;
    if (list[timing->count - 1].end > timing->to)
        timing->to = list[timing->count - 1].end;
    for (size_t i = 0; i < timing->count; i++) {
        list[i].start -= timing->from;
        list[i].end -= timing->from;
    }
    uint32_t size = timing->to - timing->from, first = list[0].start, last = list[timing->count - 1].end;
    if (size > last)
        add(timing, SIZE_MAX, last, size);
    if (first) {
        add(timing, 0, 0, 0);
        for (size_t i = timing->count - 1; i; i--)
            timing->list[i] = timing->list[i - 1];
        timing->list[0] = (struct ko_span){SIZE_MAX, 0, first};
    }
}
