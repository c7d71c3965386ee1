/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/drive_track.h"
#include "server/base/mem.h"
#include "server/stream/stream_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CLOCK_WINDOW 5.     /* s in which the fastest frame tells the distance of the clocks */
#define RESTART 1.          /* s backwards, */
#define LEAP 5.             /* or s forwards: the performer's clock has begun anew */
#define LAG_FALL 0.02       /* s per s, at which the delay gets shorter again */
#define INTERVAL_SHARE 0.1  /* of each new interval in their mean */
#define INTERVAL_FIRST 0.04 /* s */
#define INTERVAL_MAX 0.1    /* s: a longer one is a gap */

struct drive_track {
    struct driven_frame frames[DRIVE_FRAMES]; /* a ring; times are of this program's clock */
    size_t first, count;
    double last_time;   /* of the performer's clock */
    double offset;      /* this program's clock less the performer's, for frames without jitter */
    double next_offset; /* of the window in progress, which takes effect when it is over */
    double window;      /* its end */
    double heard, lateness, interval;
    double shown, weight; /* 0..1 */
    bool begun;
};

struct drive_track *drive_track_new(void) {
    struct drive_track *t = mem_alloc(sizeof *t);
    *t = (struct drive_track){.interval = INTERVAL_FIRST};
    return t;
}

void drive_track_free(struct drive_track *t) {
    free(t);
}

static struct driven_frame *frame_at(struct drive_track *t, size_t i) {
    return &t->frames[(t->first + i) % DRIVE_FRAMES];
}

/* Measures the distance of the clocks by the frame that comes with the least delay, so that jitter does not
 * count; in windows, so that clocks may drift. */
static void set_offset(struct drive_track *t, double offset, double now) {
    if (!t->begun) {
        t->offset = t->next_offset = offset;
        t->window = now + CLOCK_WINDOW;
    }
    t->next_offset = fmin(t->next_offset, offset);
    t->offset = fmin(t->offset, offset);
    if (now < t->window)
        return;
    t->offset = t->next_offset;
    t->next_offset = offset;
    t->window = now + CLOCK_WINDOW;
}

static void set_lateness(struct drive_track *t, double late, double gone) {
    t->lateness = fmax(late, t->lateness - LAG_FALL * gone);
}

void drive_track_add(struct drive_track *t, const struct driven_frame *frame, double now) {
    double step = frame->time - t->last_time;
    if (t->begun && (step < -RESTART || step > LEAP)) {
        t->begun = false;
        t->count = 0;
    }
    if (t->begun && step <= 0)
        return;
    double gone = t->begun ? now - t->heard : 0;
    set_offset(t, now - frame->time, now);
    set_lateness(t, now - frame->time - t->offset, gone);
    if (t->begun && step < INTERVAL_MAX)
        t->interval += INTERVAL_SHARE * (step - t->interval);
    t->begun = true;
    t->last_time = frame->time;
    t->heard = now;
    double last = t->count ? frame_at(t, t->count - 1)->time : -INFINITY, time = frame->time + t->offset;
    if (t->count == DRIVE_FRAMES) {
        t->first = (t->first + 1) % DRIVE_FRAMES;
        t->count--;
    }
    struct driven_frame *into = frame_at(t, t->count++);
    *into = *frame;
    into->time = fmax(time, last); /* a new offset may put it before its predecessor */
    for (int n = 3; n <= FAP_COUNT; n++)
        into->faps.value[n] = fap_clamp(n, into->faps.value[n]);
}

double drive_track_lag(const struct drive_track *t) {
    return fmin(DRIVE_LAG_MAX, fmax(DRIVE_LAG_MIN, t->lateness + t->interval));
}

double drive_track_heard(const struct drive_track *t) {
    return t->heard;
}

/* Interpolates the FAPs that both frames name. */
static void between(const struct driven_frame *a, const struct driven_frame *b, double at,
                    struct fap_frame *out) {
    double share = b->time > a->time ? fmin(1, fmax(0, (at - a->time) / (b->time - a->time))) : 1;
    *out = share < 0.5 ? a->faps : b->faps;
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(&a->faps, n) && fap_frame_has(&b->faps, n))
            out->value[n] =
                (int32_t)lround(a->faps.value[n] + share * ((double)b->faps.value[n] - a->faps.value[n]));
}

/* Finds the face at a time, and drops what is before it. Returns how long ago the newest frame was. */
static double face_at(struct drive_track *t, double at, struct fap_frame *out) {
    while (t->count > 2 && frame_at(t, 1)->time + DRIVE_LAG_MAX + DRIVE_HOLD < at) {
        t->first = (t->first + 1) % DRIVE_FRAMES;
        t->count--;
    }
    size_t i = 0;
    while (i + 2 < t->count && frame_at(t, i + 1)->time <= at)
        i++;
    const struct driven_frame *a = frame_at(t, i), *b = frame_at(t, i + 1 < t->count ? i + 1 : i);
    between(a, b, at, out);
    return at - frame_at(t, t->count - 1)->time;
}

static double smooth(double x) {
    return x * x * (3 - 2 * x);
}

void drive_track_show(struct drive_track *t, double at, bool mouth, struct fap_frame *frame) {
    struct fap_frame face;
    if (!t->count)
        return;
    double old = face_at(t, at - drive_track_lag(t), &face), gone = fmin(1, fmax(0, at - t->shown));
    t->shown = fmax(t->shown, at);
    t->weight += old <= DRIVE_HOLD ? gone / DRIVE_EASE_IN : -gone / DRIVE_EASE_OUT;
    t->weight = fmin(1, fmax(0, t->weight));
    double weight = smooth(t->weight);
    for (int n = 3; n <= FAP_COUNT; n++)
        if (fap_frame_has(&face, n) && (mouth || !face_ease_is_mouth(n)))
            fap_frame_set(frame, n,
                          (int32_t)lround(frame->value[n] + weight * (face.value[n] - frame->value[n])));
}
