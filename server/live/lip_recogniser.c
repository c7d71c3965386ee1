/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/lip_recogniser.h"
#include "server/base/mem.h"
#include "server/face/life/life_live.h"
#include "server/face/track.h"
#include "server/live/lip_features.h"
#include "server/live/lip_network.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct lip_class_name lip_classes[LIP_CLASSES] = {
    [LIP_SILENCE] = {"silence", "", "_"}, [LIP_CLOSED] = {"closed", "m", "m"},
    [LIP_TEETH] = {"teeth", "f", "f"},    [LIP_ROUNDED] = {"rounded", "ʃ", "S"},
    [LIP_DENTAL] = {"dental", "θ", "T"},  [LIP_HISS] = {"hiss", "s", "s"},
    [LIP_TIP] = {"tip", "t", "t"},        [LIP_LIQUID] = {"liquid", "l", "l"},
    [LIP_BACK] = {"back", "k", "k"},      [LIP_OPEN] = {"open", "a", "a"},
    [LIP_MIDDLE] = {"middle", "ɛ", "E"},  [LIP_MIDDLE_ROUND] = {"middle-round", "ɔ", "O"},
    [LIP_CLOSE] = {"close", "i", "i"},    [LIP_CLOSE_ROUND] = {"close-round", "u", "u"},
};

/* A closure continues while its probability is at least this. */
#define CLOSED_HOLD 0.3F
/* A class this probable starts at once, any other after some frames. */
#define SURE 0.75F
enum { LEAST_FRAMES = 2, CONTACT_FRAMES = 4 };
/* Weights of the classes: a missed closure is worse than a false one, and labiodentals are mostly missed.
 * See models/hear/README.md for the experiments. */
static const float counts[LIP_CLASSES] = {[LIP_CLOSED] = 1.4F, [LIP_TEETH] = 2};

static bool touches(enum lip_class class) {
    return class == LIP_CLOSED || class == LIP_TEETH;
}

static enum lip_class best(const float likely[LIP_CLASSES]) {
    int found = LIP_SILENCE;
    float most = likely[LIP_SILENCE];
    for (int i = 1; i < LIP_CLASSES; i++) {
        float weighed = counts[i] > 0 ? counts[i] * likely[i] : likely[i];
        if (weighed > most) {
            most = weighed;
            found = i;
        }
    }
    return (enum lip_class)found;
}

static void add(double sums[LIP_CLASSES], const float likely[LIP_CLASSES]) {
    for (int i = 0; i < LIP_CLASSES; i++)
        sums[i] += (double)likely[i];
}

void lip_decoder_begin(struct lip_decoder *d) {
    *d = (struct lip_decoder){.now = {.class = LIP_SILENCE}};
}

bool lip_decoder_step(struct lip_decoder *d, const float likely[LIP_CLASSES], struct lip_phone *ended) {
    enum lip_class heard = best(likely);
    struct lip_phone *now = &d->now;
    uint32_t frame = now->end++, age = frame - now->start;
    bool held = touches(now->class) && (age < CONTACT_FRAMES || likely[now->class] > CLOSED_HOLD);
    bool stays = heard == now->class || (held && !touches(heard));
    if (!stays && (d->since >= frame || d->next != heard)) {
        d->since = frame;
        d->next = heard;
        memset(d->next_likely, 0, sizeof d->next_likely);
        memcpy(d->before, now->likely, sizeof d->before);
    }
    add(now->likely, likely);
    if (stays) {
        d->since = now->end;
        return false;
    }
    add(d->next_likely, likely);
    if (frame - d->since + 1 < LEAST_FRAMES && !touches(heard) && likely[heard] < SURE)
        return false;
    *ended = *now;
    ended->end = d->since;
    memcpy(ended->likely, d->before, sizeof d->before);
    *now = (struct lip_phone){heard, d->since, frame + 1, {0}};
    memcpy(now->likely, d->next_likely, sizeof now->likely);
    d->since = now->end;
    return ended->end > ended->start;
}

/* The sentence made from the phones counts in milliseconds. */
enum { RATE = 1000, MS = RATE / LIP_FRAMES_A_SECOND };

/* Assumed length of the current sound: a minimum, and an extension beyond what has been heard, ms. */
enum { LASTS = 90, GOES_ON = 60, THEN_REST = 400 };

bool lip_face_speaks(const char *engine, const struct speech_pack *pack) {
    return !engine || !strcmp(engine, LIP_ENGINE) || face_engine_speaks(engine, pack);
}

/* Adds a finished phone. */
static void lip_face_add(struct lip_face *f, const struct lip_phone *phone) {
    size_t old = f->count == LIP_FACE_PHONES;
    while (old < f->count && f->phones[old].end + LIP_FACE_REACH < phone->end)
        old++;
    f->count -= old;
    memmove(f->phones, f->phones + old, f->count * sizeof *f->phones);
    f->phones[f->count++] = *phone;
}

static void put(struct phone *out, enum lip_class class, uint32_t start, uint32_t end) {
    *out = (struct phone){.start = start, .end = end};
    snprintf(out->ipa, sizeof out->ipa, "%s", lip_classes[class].ipa);
    snprintf(out->sampa, sizeof out->sampa, "%s", lip_classes[class].sampa);
}

/* Computes the mouth at t s, where `now` is the current phone and `mouth` the network's prediction, mm. */
static void lip_face_sample(struct lip_face *f, const struct lip_phone *now, const double mouth[PARAM_COUNT],
                            double t, struct fap_frame *frame) {
    struct phone phones[LIP_FACE_PHONES + 3];
    size_t count = 0;
    int64_t zero = (int64_t)(f->count ? f->phones[0].start : now->start) * MS - THEN_REST;
    put(&phones[count++], LIP_SILENCE, 0, THEN_REST);
    for (size_t i = 0; i < f->count; i++) {
        const struct lip_phone *p = &f->phones[i];
        put(&phones[count++], p->class, (uint32_t)((int64_t)p->start * MS - zero),
            (uint32_t)((int64_t)p->end * MS - zero));
    }
    uint32_t start = (uint32_t)((int64_t)now->start * MS - zero),
             end = (uint32_t)((int64_t)now->end * MS - zero);
    end = end + GOES_ON > start + LASTS ? end + GOES_ON : start + LASTS;
    put(&phones[count++], now->class, start, end);
    put(&phones[count++], LIP_SILENCE, end, end + THEN_REST);
    struct sentence_audio audio = {
        .sample_rate = RATE, .samples = end + THEN_REST, .phones = phones, .phone_count = count};
    const struct face_options options = {.engine = f->engine, .still = true};
    struct face_track *track = face_track_new(f->pack, &audio, &options, NULL, NULL);
    face_track_sample_mouth(track, t - LIP_FIRST_SECONDS - (double)zero / RATE, f->engine ? NULL : mouth,
                            frame);
    face_track_free(track);
}

/* Limit per frame; voice is accepted faster than music. See models/hear/README.md for the experiments. */
#define ODDS_MOST 4.0F
#define FALLS 0.015F
#define RISES 0.04F
/* From 1 (voice) to -1; the decision changes only when the evidence reaches the other side. */
#define NONE -0.9F
#define SOMEBODY -0.5F

void lip_voice_begin(struct lip_voice *v) {
    *v = (struct lip_voice){.evidence = 1};
}

void lip_voice_step(struct lip_voice *v, float odds, float silence) {
    float counts = (1 - silence) * fmaxf(-ODDS_MOST, fminf(ODDS_MOST, odds));
    v->evidence = fmaxf(-1, fminf(1, v->evidence + counts * (counts > 0 ? RISES : FALLS)));
    v->none = v->none ? v->evidence < SOMEBODY : v->evidence < NONE;
}

/* In silence the mouth moves to rest: fraction of the way per frame, and back. */
#define FALLS_ASLEEP 0.05F
#define WAKES 0.25F

struct lip_recogniser {
    struct lip_recogniser_options options;
    struct lip_input *sound;
    struct lip_features *features;
    struct lip_state *state;
    struct lip_voice voice;
    struct lip_decoder decoder;
    struct lip_face face;
    float mouth[2][PARAM_COUNT]; /* mm, of the last two frames */
    float awake;                 /* 0 at rest .. 1 as predicted */
    struct life_live *life;      /* NULL = mouth only */
    size_t head;
    unsigned delay;   /* frames */
    uint32_t heard;   /* frames of features */
    uint32_t shown;   /* frames of the face */
    uint64_t written; /* samples of each channel */
    double end;       /* s; infinite until known */
};

double hear_seconds(uint32_t frames) {
    return frames ? LIP_FIRST_SECONDS + (double)frames / LIP_FRAMES_A_SECOND : 0;
}

/* Interpolates between the last two frames. */
static void mouth_at(const struct lip_recogniser *l, double t, double mm[PARAM_COUNT]) {
    double last = hear_seconds(l->decoder.now.end) - 0.5 / LIP_FRAMES_A_SECOND;
    double before = fmax(0, fmin(1, (last - t) * LIP_FRAMES_A_SECOND));
    for (int p = 0; p < PARAM_COUNT; p++)
        mm[p] = before * (double)l->mouth[0][p] + (1 - before) * (double)l->mouth[1][p];
}

/* Emits the frames that are known. */
static void show(struct lip_recogniser *l, double until) {
    struct fap_frame frame;
    double mm[PARAM_COUNT];
    for (double t; (t = l->shown / l->options.fps) <= until && t < l->end; l->shown++) {
        mouth_at(l, t, mm);
        lip_face_sample(&l->face, &l->decoder.now, mm, t, &frame);
        if (l->life)
            life_live_add(l->life, t, &frame);
        l->options.frame(l->options.ctx, l->shown, &frame);
    }
}

static void take_mouth(struct lip_recogniser *l, const float mouth[PARAM_COUNT]) {
    bool silent = l->decoder.now.class == LIP_SILENCE;
    l->awake = silent ? fmaxf(0, l->awake - FALLS_ASLEEP) : fminf(1, l->awake + WAKES);
    memcpy(l->mouth[0], l->mouth[1], sizeof l->mouth[0]);
    for (int p = 0; p < PARAM_COUNT; p++)
        l->mouth[1][p] = l->awake * mouth[p];
}

/* Treats music as silence. */
static void quieten(struct lip_recogniser *l, struct lip_answer *answer) {
    lip_voice_step(&l->voice, answer->voice, answer->likely[LIP_SILENCE]);
    if (!l->voice.none)
        return;
    memset(answer->likely, 0, sizeof answer->likely);
    answer->likely[LIP_SILENCE] = 1;
}

static void on_features(void *ctx, const float features[LIP_FEATURES]) {
    struct lip_recogniser *l = ctx;
    struct lip_answer answer;
    struct lip_phone ended;
    lip_state_step(l->state, features, l->head, &answer);
    quieten(l, &answer);
    if (l->life)
        life_live_step(l->life);
    if (l->heard++ < l->delay || hear_seconds(l->decoder.now.end) >= l->end)
        return;
    if (lip_decoder_step(&l->decoder, answer.likely, &ended)) {
        lip_face_add(&l->face, &ended);
        if (l->options.phone)
            l->options.phone(l->options.ctx, &ended);
    }
    take_mouth(l, answer.mouth);
    show(l, hear_seconds(l->decoder.now.end));
}

static void on_sound(void *ctx, const float *samples, size_t count) {
    struct lip_recogniser *l = ctx;
    if (l->life)
        life_live_write(l->life, samples, count);
    lip_features_write(l->features, samples, count);
}

static int choose_head(struct lip_recogniser *l, unsigned lookahead, struct error *e) {
    unsigned delays[LIP_HEADS_MOST];
    size_t count = lip_network_delays(l->options.network, delays);
    for (l->head = 0; l->head < count; l->head++)
        if (delays[l->head] * 1000 / LIP_FRAMES_A_SECOND == lookahead) {
            l->delay = delays[l->head];
            return 0;
        }
    return error_in_field(e, ERROR_BAD_FIELD, "lookahead", "there is no lookahead of %u ms", lookahead);
}

struct lip_recogniser *lip_recogniser_new(const struct lip_recogniser_options *options, struct error *e) {
    struct lip_recogniser *l = mem_alloc(sizeof *l);
    l->options = *options;
    l->face.pack = options->pack;
    if (options->engine && strcmp(options->engine, LIP_ENGINE) != 0)
        l->face.engine = options->engine;
    l->end = INFINITY;
    lip_voice_begin(&l->voice);
    lip_decoder_begin(&l->decoder);
    if (!choose_head(l, options->lookahead, e))
        l->sound = lip_input_new(options->rate, options->channels, on_sound, l, e);
    if (!l->sound) {
        free(l);
        return NULL;
    }
    l->features = lip_features_new(on_features, l);
    l->state = lip_state_new(options->network);
    if (options->lives)
        l->life = life_live_new();
    return l;
}

void lip_recogniser_free(struct lip_recogniser *l) {
    if (!l)
        return;
    lip_input_free(l->sound);
    lip_features_free(l->features);
    lip_state_free(l->state);
    life_live_free(l->life);
    free(l);
}

void lip_recogniser_write(struct lip_recogniser *l, const float *samples, size_t frames) {
    l->written += frames;
    lip_input_write(l->sound, samples, frames);
}

void lip_recogniser_end(struct lip_recogniser *l) {
    static const float silence[LIP_WINDOW];
    lip_input_end(l->sound);
    l->end = (double)l->written / l->options.rate;
    if (!l->written)
        return;
    for (unsigned i = 0; i < l->delay * LIP_HOP / LIP_WINDOW + 2; i++)
        lip_features_write(l->features, silence, LIP_WINDOW);
    show(l, l->end);
    if (l->options.phone && l->decoder.now.end)
        l->options.phone(l->options.ctx, &l->decoder.now);
}
