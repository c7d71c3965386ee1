/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/stream/stream_internal.h"
#include "server/synthesis/media_segment.h"
#include <math.h>
#include <stdlib.h>

bool face_ease_is_mouth(int n) {
    return (n >= 3 && n <= 18) || (n >= 43 && n <= 47) || (n >= 51 && n <= 60);
}

static double smooth(double x) {
    return x >= 1 ? 1 : x * x * (3 - 2 * x);
}

/* Interpolates each FAP: any mixture of two possible faces is possible (lids and lips do not pass through
 * each other). */
static void mix(struct fap_frame *frame, const struct fap_frame *from, double mouth, double upper) {
    for (int n = 3; n <= FAP_COUNT; n++) {
        double w = face_ease_is_mouth(n) ? mouth : upper;
        if (w < 1 && frame->value[n] != from->value[n])
            frame->value[n] = (int32_t)lround(from->value[n] + w * (frame->value[n] - from->value[n]));
    }
}

void face_ease_cut(struct face_ease *ease, const struct fap_frame *from, uint64_t now) {
    ease->until = now + EASE_SOON_MS;
    ease->from_is_set = from != NULL;
    if (from)
        ease->from = *from;
}

static void begin(struct face_ease *ease, uint64_t now) {
    if (!ease->until)
        return;
    ease->active = ease->shown && now < ease->until;
    ease->age = 0;
    ease->until = 0;
    if (!ease->from_is_set)
        ease->from = ease->last;
}

void face_ease_frames(struct face_ease *ease, enum ease_what what, uint64_t now, double fps,
                      struct fap_frame *frames, size_t count) {
    if (!count)
        return;
    begin(ease, now);
    ease->active = ease->active && what != EASE_NOTHING;
    for (size_t i = 0; i < count && ease->active; i++) {
        ease->age += 1 / fps;
        mix(&frames[i], &ease->from, what == EASE_ALL ? smooth(ease->age / EASE_MOUTH) : 1,
            smooth(ease->age / EASE_UPPER));
        ease->active = ease->age < EASE_UPPER;
    }
    ease->last = frames[count - 1];
    ease->shown = true;
}

void face_ease_towards(const struct fap_frame *to, struct fap_frame *frames, double from, double end,
                       size_t count) {
    for (size_t i = 0; i < count; i++) {
        double left = 1 - smooth(from + (end - from) * (double)(i + 1) / (double)count);
        mix(&frames[i], to, left, left);
    }
}

#define LONG_AGO 60 /* s: enough for any mood change to be complete */

static void forget(struct mood_mix *mix) {
    for (size_t i = 0; i < mix->asked.count; i++)
        free((char *)mix->asked.names[i]);
    mix->asked = (struct mood_request){0};
}

void mood_mix_open(struct mood_mix *mix, const struct expressions *expressions) {
    *mix = (struct mood_mix){.expressions = expressions_share(expressions),
                             .mood = expressions ? mood_new(expressions) : NULL};
}

void mood_mix_close(struct mood_mix *mix) {
    mood_free(mix->mood);
    expressions_free(mix->expressions);
    forget(mix);
}

int mood_mix_set(struct mood_mix *mix, const struct mood_request *asked, double at, struct error *e) {
    if (!mix->mood && asked->count)
        return error_in_field(e, ERROR_UNKNOWN_EXPRESSION, "mix.0.name", "the models have no expressions");
    /* after a stop the clock may be slightly before media already sent */
    at = fmax(at, mix->last);
    if (mix->mood && mood_set(mix->mood, asked->names, asked->intensities, asked->count, at, asked->ease, e))
        return -1;
    forget(mix);
    mix->last = at;
    mix->asked = *asked;
    for (size_t i = 0; i < asked->count; i++)
        mix->asked.names[i] = mem_strdup(asked->names[i]);
    return 0;
}

void mood_mix_follow(const struct mood_mix *mix, struct mood *copy, double at) {
    const struct mood_request *asked = &mix->asked;
    struct error e;
    if (copy) /* the names were freed with the old request */
        mood_set(copy, asked->names, asked->intensities, asked->count, at, asked->ease, &e);
}

struct mood *mood_mix_copy(const struct mood_mix *mix) {
    struct mood *copy = mix->expressions ? mood_new(mix->expressions) : NULL;
    struct mood_mix at_once = *mix;
    at_once.asked.ease = 0;
    mood_mix_follow(&at_once, copy, -LONG_AGO);
    return copy;
}

struct idle_face {
    struct idle_options options;
    struct face_placement *face;
    uint64_t begin; /* loop time of the idle clock's 0, ms */
    bool begun;     /* the first chunk was made; it defines the clock's 0, however late it came */
};

struct idle_face *idle_face_new(const struct idle_options *options, const struct mood *mood, uint64_t now) {
    const struct placement_options face = {
        .still = options->still, .life = options->life, .seed = options->seed, .mood = mood};
    struct idle_face *idle = mem_alloc(sizeof *idle);
    *idle = (struct idle_face){*options, face_placement_new(NULL, NULL, &face), now, false};
    return idle;
}

void idle_face_free(struct idle_face *idle) {
    if (!idle)
        return;
    face_placement_free(idle->face);
    free(idle);
}

bool idle_face_is(const struct idle_face *idle, const struct idle_options *o) {
    const struct idle_options *has = &idle->options;
    return has->life == o->life && has->seed == o->seed && has->fps == o->fps && has->still == o->still;
}

double idle_face_time(const struct idle_face *idle, uint64_t at) {
    return (double)(at - idle->begin) / 1000;
}

void idle_face_media(struct idle_face *idle, uint64_t at, unsigned ms, double life, struct media *media) {
    const uint32_t samples = IDLE_SAMPLE_RATE * ms / 1000;
    uint64_t start = (at - idle->begin) * IDLE_SAMPLE_RATE / 1000;
    if (!idle->begun || start > UINT32_MAX - samples) {
        idle->begin = at;
        idle->begun = true;
        start = 0;
    }
    double fps = idle->options.fps;
    uint32_t first = frame_from_sample(start, IDLE_SAMPLE_RATE, fps);
    uint32_t end = frame_from_sample(start + samples, IDLE_SAMPLE_RATE, fps);
    for (uint32_t k = first; k < end; k++)
        face_placement_sample(idle->face, life + k / fps - (double)start / IDLE_SAMPLE_RATE,
                              &media->frames[k - first]);
    *media = (struct media){.sample_rate = IDLE_SAMPLE_RATE,
                            .fps = fps,
                            .start = (uint32_t)start,
                            .samples = samples,
                            .first_frame = first,
                            .frame_count = end - first,
                            .frames = media->frames};
}
