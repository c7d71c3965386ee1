/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/jitter_buffer.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Samples that interpolation needs around a position. */
enum { BEFORE = 1, BEHIND = 2 };

void jitter_buffer_open(struct jitter_buffer *p, unsigned rate, size_t most) {
    *p = (struct jitter_buffer){.rate = rate, .most = most};
    jitter_buffer_begin(p);
}

void jitter_buffer_free(struct jitter_buffer *p) {
    free(p->samples);
    p->samples = NULL;
}

void jitter_buffer_begin(struct jitter_buffer *p) {
    p->begun = p->wanted = -1;
    p->came = p->taken = 0;
    p->windows = 0;
    p->speed = 0;
}

static double clear(double seconds) {
    return fabs(seconds) < JITTER_TOLERANCE ? 0 : seconds;
}

static void end_window(struct jitter_buffer *p) {
    if (p->windows == JITTER_WINDOWS)
        memmove(p->history, p->history + 1, --p->windows * sizeof *p->history);
    p->history[p->windows++] = p->most_came;
    if (p->wanted < 0)
        p->wanted = fmin(fmax(p->most_ahead, 0), JITTER_WAIT);
    double drift = clear(p->most_came - p->history[0]) / (JITTER_WINDOW * fmax(1, p->windows - 1));
    double speed = drift + clear(p->most_ahead - p->wanted) / JITTER_SETTLE;
    p->speed = fmax(-JITTER_MAX, fmin(JITTER_MAX, speed));
}

static void measure(struct jitter_buffer *p, double now) {
    if (p->begun < 0) {
        p->begun = p->window = now;
        p->most_came = p->most_ahead = -INFINITY;
    }
    double passed = now - p->begun;
    p->most_came = fmax(p->most_came, (double)p->came / p->rate - passed);
    p->most_ahead = fmax(p->most_ahead, (double)(p->taken + p->count) / p->rate - passed);
    if (now - p->window < JITTER_WINDOW)
        return;
    end_window(p);
    p->window = now;
    p->most_came = p->most_ahead = -INFINITY;
}

size_t jitter_buffer_catch_up(struct jitter_buffer *p) {
    size_t keep = (size_t)(p->rate * JITTER_KEEP);
    if (p->count <= keep)
        return 0;
    size_t out = p->count - keep;
    p->first += out;
    p->count = keep;
    jitter_buffer_begin(p);
    return out;
}

/* Moves the waiting samples back to the start of the buffer. */
static void compact(struct jitter_buffer *p) {
    if (p->first <= BEFORE)
        return;
    size_t gone = p->first - BEFORE;
    memmove(p->samples, p->samples + gone, (BEFORE + p->count) * sizeof *p->samples);
    p->first = BEFORE;
}

size_t jitter_buffer_add(struct jitter_buffer *p, const int16_t *samples, size_t count, double now) {
    if (!p->samples) {
        p->samples = mem_grow(NULL, &p->cap, BEFORE + count, sizeof *p->samples);
        p->samples[0] = 0;
        p->first = BEFORE;
    }
    compact(p);
    p->samples = mem_grow(p->samples, &p->cap, p->first + p->count + count, sizeof *p->samples);
    memcpy(p->samples + p->first + p->count, samples, count * sizeof *samples);
    p->count += count;
    p->came += count;
    measure(p, now);
    return p->count > p->most ? jitter_buffer_catch_up(p) : 0;
}

/* Interpolates between y[0] and y[1] (Catmull and Rom, 1974). */
static int16_t at(const int16_t *y, double x) {
    double a = y[-1], b = y[0], c = y[1], d = y[2];
    double value = b + 0.5 * x * (c - a + x * (2 * a - 5 * b + 4 * c - d + x * (3 * (b - c) + d - a)));
    return (int16_t)lrint(fmax(-32768, fmin(32767, value)));
}

size_t jitter_buffer_take(struct jitter_buffer *p, int16_t *out, size_t count) {
    size_t done = 0;
    if (p->between == 0 && p->speed == 0) {
        done = count < p->count ? count : p->count;
        if (done)
            memcpy(out, p->samples + p->first, done * sizeof *out);
        p->first += done;
        p->count -= done;
    }
    while (done < count && p->count > BEHIND) {
        out[done++] = at(p->samples + p->first, p->between);
        p->between += 1 + p->speed;
        size_t steps = (size_t)p->between;
        p->between -= (double)steps;
        p->first += steps;
        p->count -= steps;
    }
    p->taken += done;
    return done;
}
