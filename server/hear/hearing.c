/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hearing.h"
#include "server/base/mem.h"
#include "server/face/life/life_heard.h"
#include "server/hear/hear_sound.h"
#include "server/hear/hear_voice.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In silence, and when nobody speaks, the mouth goes to rest, to the bit: how much of the way it goes in a
 * frame, and back. */
#define FALLS_ASLEEP 0.05F
#define WAKES 0.25F

struct hearing {
    struct hearing_options options;
    struct hear_sound *sound;
    struct hear_features *features;
    struct hear_state *state;
    struct hear_voice voice;
    struct hear_decoder decoder;
    struct hear_face face;
    float mouth[2][PARAM_COUNT]; /* mm, of the last two frames */
    float awake;                 /* 0: at rest .. 1: as the network tells */
    struct life_heard *life;     /* NULL: the mouth alone */
    size_t head;
    unsigned delay;   /* frames */
    uint32_t heard;   /* frames of features */
    uint32_t shown;   /* frames of the face */
    uint64_t written; /* samples of each channel */
    double end;       /* s, of the sound; infinite until it is known */
};

double hear_seconds(uint32_t frames) {
    return frames ? HEAR_FIRST_SECONDS + (double)frames / HEAR_FRAMES_A_SECOND : 0;
}

/* Between the middles of the last two frames. */
static void mouth_at(const struct hearing *l, double t, double mm[PARAM_COUNT]) {
    double last = hear_seconds(l->decoder.now.end) - 0.5 / HEAR_FRAMES_A_SECOND;
    double before = fmax(0, fmin(1, (last - t) * HEAR_FRAMES_A_SECOND));
    for (int p = 0; p < PARAM_COUNT; p++)
        mm[p] = before * (double)l->mouth[0][p] + (1 - before) * (double)l->mouth[1][p];
}

/* The face as far as it is known. */
static void show(struct hearing *l, double until) {
    struct fap_frame frame;
    double mm[PARAM_COUNT];
    for (double t; (t = l->shown / l->options.fps) <= until && t < l->end; l->shown++) {
        mouth_at(l, t, mm);
        hear_face_sample(&l->face, &l->decoder.now, mm, t, &frame);
        if (l->life)
            life_heard_add(l->life, t, &frame);
        l->options.frame(l->options.ctx, l->shown, &frame);
    }
}

static void take_mouth(struct hearing *l, const float mouth[PARAM_COUNT]) {
    bool silent = l->decoder.now.class == HEAR_SILENCE;
    l->awake = silent ? fmaxf(0, l->awake - FALLS_ASLEEP) : fminf(1, l->awake + WAKES);
    memcpy(l->mouth[0], l->mouth[1], sizeof l->mouth[0]);
    for (int p = 0; p < PARAM_COUNT; p++)
        l->mouth[1][p] = l->awake * mouth[p];
}

/* Music is silence as far as a mouth goes. */
static void quieten(struct hearing *l, struct hear_answer *answer) {
    hear_voice_step(&l->voice, answer->voice, answer->likely[HEAR_SILENCE]);
    if (!l->voice.none)
        return;
    memset(answer->likely, 0, sizeof answer->likely);
    answer->likely[HEAR_SILENCE] = 1;
}

static void on_features(void *ctx, const float features[HEAR_FEATURES]) {
    struct hearing *l = ctx;
    struct hear_answer answer;
    struct hear_phone ended;
    hear_state_step(l->state, features, l->head, &answer);
    quieten(l, &answer);
    if (l->life)
        life_heard_step(l->life);
    if (l->heard++ < l->delay || hear_seconds(l->decoder.now.end) >= l->end)
        return;
    if (hear_decoder_step(&l->decoder, answer.likely, &ended)) {
        hear_face_add(&l->face, &ended);
        if (l->options.phone)
            l->options.phone(l->options.ctx, &ended);
    }
    take_mouth(l, answer.mouth);
    show(l, hear_seconds(l->decoder.now.end));
}

static void on_sound(void *ctx, const float *samples, size_t count) {
    struct hearing *l = ctx;
    if (l->life)
        life_heard_write(l->life, samples, count);
    hear_features_write(l->features, samples, count);
}

static int choose_head(struct hearing *l, unsigned lookahead, struct error *e) {
    unsigned delays[HEAR_HEADS_MOST];
    size_t count = hear_network_delays(l->options.network, delays);
    for (l->head = 0; l->head < count; l->head++)
        if (delays[l->head] * 1000 / HEAR_FRAMES_A_SECOND == lookahead) {
            l->delay = delays[l->head];
            return 0;
        }
    return error_in_field(e, ERROR_BAD_FIELD, "lookahead", "there is none of %u ms", lookahead);
}

struct hearing *hearing_new(const struct hearing_options *options, struct error *e) {
    struct hearing *l = mem_alloc(sizeof *l);
    l->options = *options;
    l->face.pack = options->pack;
    if (options->engine && strcmp(options->engine, HEAR_ENGINE) != 0)
        l->face.engine = options->engine;
    l->end = INFINITY;
    hear_voice_begin(&l->voice);
    hear_decoder_begin(&l->decoder);
    if (!choose_head(l, options->lookahead, e))
        l->sound = hear_sound_new(options->rate, options->channels, on_sound, l, e);
    if (!l->sound) {
        free(l);
        return NULL;
    }
    l->features = hear_features_new(on_features, l);
    l->state = hear_state_new(options->network);
    if (options->lives)
        l->life = life_heard_new();
    return l;
}

void hearing_free(struct hearing *l) {
    if (!l)
        return;
    hear_sound_free(l->sound);
    hear_features_free(l->features);
    hear_state_free(l->state);
    life_heard_free(l->life);
    free(l);
}

void hearing_write(struct hearing *l, const float *samples, size_t frames) {
    l->written += frames;
    hear_sound_write(l->sound, samples, frames);
}

void hearing_end(struct hearing *l) {
    static const float silence[HEAR_WINDOW];
    hear_sound_end(l->sound);
    l->end = (double)l->written / l->options.rate;
    if (!l->written)
        return;
    for (unsigned i = 0; i < l->delay * HEAR_HOP / HEAR_WINDOW + 2; i++)
        hear_features_write(l->features, silence, HEAR_WINDOW);
    show(l, l->end);
    if (l->options.phone && l->decoder.now.end)
        l->options.phone(l->options.ctx, &l->decoder.now);
}
