/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/stream/idle_face.h"
#include "server/base/mem.h"
#include <stdlib.h>

enum { SAMPLES = IDLE_SAMPLE_RATE * IDLE_CHUNK_MS / 1000 };

struct idle_face {
    struct idle_options options;
    struct face_placement *face;
    uint64_t begin; /* loop time of the idle clock's 0, ms */
    bool begun;     /* the first chunk has been made: it is the clock's 0, however late it came */
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

void idle_face_media(struct idle_face *idle, uint64_t at, double life, struct media *media) {
    uint64_t start = (at - idle->begin) * IDLE_SAMPLE_RATE / 1000;
    if (!idle->begun || start > UINT32_MAX - SAMPLES) {
        idle->begin = at;
        idle->begun = true;
        start = 0;
    }
    double fps = idle->options.fps;
    uint32_t first = frame_from_sample(start, IDLE_SAMPLE_RATE, fps);
    uint32_t end = frame_from_sample(start + SAMPLES, IDLE_SAMPLE_RATE, fps);
    for (uint32_t k = first; k < end; k++)
        face_placement_sample(idle->face, life + k / fps - (double)start / IDLE_SAMPLE_RATE,
                              &media->frames[k - first]);
    *media = (struct media){.sample_rate = IDLE_SAMPLE_RATE,
                            .fps = fps,
                            .start = (uint32_t)start,
                            .samples = SAMPLES,
                            .first_frame = first,
                            .frame_count = end - first,
                            .frames = media->frames};
}
