/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/research/life_statistics.h"
#include "server/base/mem.h"
#include <math.h>
#include <stdlib.h>

#define DEGREE 1745.33
#define LIDS 940.0  /* FAP 19 of a closed eye */
#define FOLLOW 15.0 /* units by which the lid follows the eye per degree */
#define BLINK_BEGINS 0.08
#define BLINK_COUNTS 0.4
#define BLINK_COMPLETE 0.95
#define SACCADE_SPEED 20.0 /* degrees per second; slower movement is drift or the head */
#define SACCADE_SMALLEST 0.5

static void push(struct life_list *list, double x) {
    list->items = mem_grow(list->items, &list->cap, list->count + 1, sizeof *list->items);
    list->items[list->count++] = x;
}

static double moment(const struct life_list *list, double about, int order) {
    double sum = 0;
    for (size_t i = 0; i < list->count; i++)
        sum += pow(list->items[i] - about, order);
    return list->count ? sum / (double)list->count : 0;
}

double life_list_mean(const struct life_list *list) {
    return moment(list, 0, 1);
}

double life_list_deviation(const struct life_list *list) {
    return sqrt(moment(list, life_list_mean(list), 2));
}

double life_list_skewness(const struct life_list *list) {
    double deviation = life_list_deviation(list);
    return deviation > 0 ? moment(list, life_list_mean(list), 3) / pow(deviation, 3) : 0;
}

void life_statistics_init(struct life_statistics *s, double fps) {
    *s = (struct life_statistics){.fps = fps, .blink_from = -1, .away_from = -1};
}

void life_statistics_free(struct life_statistics *s) {
    free(s->intervals.items);
    free(s->durations.items);
    free(s->saccades.items);
    free(s->away.items);
}

static void see_lids(struct life_statistics *s, double now, double closed) {
    if (!s->closed && closed > BLINK_BEGINS) {
        s->closed = true;
        s->since_blink = now;
        s->deepest = 0;
    }
    if (!s->closed)
        return;
    s->deepest = fmax(s->deepest, closed);
    if (closed > BLINK_BEGINS)
        return;
    s->closed = false;
    if (s->deepest < BLINK_COUNTS)
        return;
    s->blinks++;
    s->incomplete += s->deepest < BLINK_COMPLETE;
    push(&s->durations, now - s->since_blink);
    if (s->blink_from >= 0)
        push(&s->intervals, s->since_blink - s->blink_from);
    s->blink_from = s->since_blink;
}

static void see_gaze(struct life_statistics *s, double now, const double gaze[2]) {
    double step = hypot(gaze[0] - s->gaze[0], gaze[1] - s->gaze[1]);
    bool fast = step * s->fps > SACCADE_SPEED;
    if (fast && !s->jumping) {
        s->jump[0] = s->gaze[0];
        s->jump[1] = s->gaze[1];
    }
    if (!fast && s->jumping) {
        double size = hypot(gaze[0] - s->jump[0], gaze[1] - s->jump[1]);
        if (size >= SACCADE_SMALLEST)
            push(&s->saccades, size);
    }
    s->jumping = fast;
    s->gaze[0] = gaze[0];
    s->gaze[1] = gaze[1];
    bool there = hypot(gaze[0], gaze[1]) <= LIFE_LISTENER_DEGREES;
    s->at_listener += there;
    if (!there && s->away_from < 0)
        s->away_from = now;
    if (there && s->away_from >= 0) {
        push(&s->away, now - s->away_from);
        s->away_from = -1;
    }
}

static void see_head(struct life_statistics *s, const double head[3]) {
    for (int i = 0; i < 3; i++) {
        double velocity = (head[i] - s->head[i]) * s->fps;
        if (!s->frames)
            s->low[i] = s->high[i] = head[i];
        s->low[i] = fmin(s->low[i], head[i]);
        s->high[i] = fmax(s->high[i], head[i]);
        s->sum[i] += head[i];
        s->square[i] += head[i] * head[i];
        if (s->frames)
            s->speed[i] = fmax(s->speed[i], fabs(velocity));
        if (s->frames > 1)
            s->acceleration[i] = fmax(s->acceleration[i], fabs(velocity - s->velocity[i]) * s->fps);
        s->velocity[i] = velocity;
        s->head[i] = head[i];
    }
}

void life_statistics_add(struct life_statistics *s, const struct fap_frame *frame) {
    const int32_t *v = frame->value;
    double now = (double)s->frames / s->fps;
    double head[3] = {v[48] / DEGREE, v[49] / DEGREE, v[50] / DEGREE};
    see_lids(s, now, (v[19] - FOLLOW * v[25] / DEGREE) / LIDS);
    see_gaze(s, now, (const double[]){v[23] / DEGREE + head[1], v[25] / DEGREE + head[0]});
    see_head(s, head);
    s->frames++;
}
