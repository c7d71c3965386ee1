/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/synthesis/heard_pace.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Samples beside the one that is read between: one before, two behind. */
enum { BEFORE = 1, BEHIND = 2 };

void heard_pace_open(struct heard_pace *p, unsigned rate, size_t most) {
    *p = (struct heard_pace){.rate = rate, .most = most};
    heard_pace_begin(p);
}

void heard_pace_free(struct heard_pace *p) {
    free(p->samples);
    p->samples = NULL;
}

void heard_pace_begin(struct heard_pace *p) {
    p->begun = p->wanted = -1;
    p->came = p->taken = 0;
    p->windows = 0;
    p->speed = 0;
}

static double clear(double seconds) {
    return fabs(seconds) < PACE_BLUR ? 0 : seconds;
}

static void end_window(struct heard_pace *p) {
    if (p->windows == PACE_WINDOWS)
        memmove(p->history, p->history + 1, --p->windows * sizeof *p->history);
    p->history[p->windows++] = p->most_came;
    if (p->wanted < 0)
        p->wanted = fmin(fmax(p->most_ahead, 0), PACE_WAIT);
    double drift = clear(p->most_came - p->history[0]) / (PACE_WINDOW * fmax(1, p->windows - 1));
    double speed = drift + clear(p->most_ahead - p->wanted) / PACE_SETTLE;
    p->speed = fmax(-PACE_MOST, fmin(PACE_MOST, speed));
}

static void measure(struct heard_pace *p, double now) {
    if (p->begun < 0) {
        p->begun = p->window = now;
        p->most_came = p->most_ahead = -INFINITY;
    }
    double passed = now - p->begun;
    p->most_came = fmax(p->most_came, (double)p->came / p->rate - passed);
    p->most_ahead = fmax(p->most_ahead, (double)(p->taken + p->count) / p->rate - passed);
    if (now - p->window < PACE_WINDOW)
        return;
    end_window(p);
    p->window = now;
    p->most_came = p->most_ahead = -INFINITY;
}

size_t heard_pace_catch_up(struct heard_pace *p) {
    size_t keep = (size_t)(p->rate * PACE_KEEP);
    if (p->count <= keep)
        return 0;
    size_t out = p->count - keep;
    p->first += out;
    p->count = keep;
    heard_pace_begin(p);
    return out;
}

/* The samples that wait begin at BEFORE again. */
static void tidy(struct heard_pace *p) {
    if (p->first <= BEFORE)
        return;
    size_t gone = p->first - BEFORE;
    memmove(p->samples, p->samples + gone, (BEFORE + p->count) * sizeof *p->samples);
    p->first = BEFORE;
}

size_t heard_pace_add(struct heard_pace *p, const int16_t *samples, size_t count, double now) {
    if (!p->samples) {
        p->samples = mem_grow(NULL, &p->cap, BEFORE + count, sizeof *p->samples);
        p->samples[0] = 0;
        p->first = BEFORE;
    }
    tidy(p);
    p->samples = mem_grow(p->samples, &p->cap, p->first + p->count + count, sizeof *p->samples);
    memcpy(p->samples + p->first + p->count, samples, count * sizeof *samples);
    p->count += count;
    p->came += count;
    measure(p, now);
    return p->count > p->most ? heard_pace_catch_up(p) : 0;
}

/* Between y[0] and y[1] (Catmull and Rom, 1974). */
static int16_t at(const int16_t *y, double x) {
    double a = y[-1], b = y[0], c = y[1], d = y[2];
    double value = b + 0.5 * x * (c - a + x * (2 * a - 5 * b + 4 * c - d + x * (3 * (b - c) + d - a)));
    return (int16_t)lrint(fmax(-32768, fmin(32767, value)));
}

size_t heard_pace_take(struct heard_pace *p, int16_t *out, size_t count) {
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
