/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/coach/judge.h"
#include "server/base/mem.h"
#include "server/library/align/refine.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const judge_states[JUDGE_STATES] = {"unsure", "good", "different"};

/* ---- thresholds, chosen by tests/bench/coach.mjs --choose on recordings of people; the docs have the
 * figures of others ---- */

/* A phone is different below this score. Chosen so that 5 % of the phones that people say as they should, or
 * nearly, would be called different. Of /θ ð/, which the recogniser never hears, none is. */
static const float different_below[LIP_CLASSES] = {
    [LIP_CLOSED] = -3.4F,     [LIP_TEETH] = -3.9F,  [LIP_ROUNDED] = -4.3F,      [LIP_DENTAL] = -INFINITY,
    [LIP_HISS] = -3.2F,       [LIP_TIP] = -3.4F,    [LIP_LIQUID] = -4.1F,       [LIP_BACK] = -3.7F,
    [LIP_OPEN] = -3.3F,       [LIP_MIDDLE] = -3.8F, [LIP_MIDDLE_ROUND] = -3.6F, [LIP_CLOSE] = -3.4F,
    [LIP_CLOSE_ROUND] = -4.1F};
/* And good from this on. */
#define GOOD_FROM (-0.3)
/* Mean log probability of the expected classes below which the recording seems to hold other words. */
#define UNSAID (-2.4)
/* Share of a word's phones that must be good for the word to be. */
#define GOOD_SHARE 0.5

/* What was heard of the recording, frame by frame, and where the model's phones lie in it. */
struct judging {
    const struct reference_speech *model;
    const atomic_bool *stop;
    struct align_sound part;               /* of the recording: without the silence around the speech */
    double before;                         /* s of the recording before it */
    struct sound_likelihoods *all, *heard; /* of the recording; where `part` begins in it */
    struct align_map map;
    struct refine_phone *placed;
    size_t *phone_of; /* index in the model of each placed phone */
    size_t count;
};

/* ---- the part that is speech ---- */

/* Silence kept around the speech, in frames of 8 ms, and the log probability from which a frame is silent. */
enum { MARGIN = 20, SPEECH_LEAST = 4 };
#define SILENT (-0.7F)

static size_t frames_of(size_t samples, uint32_t rate) {
    return (size_t)((double)samples * FEATURE_RATE / rate / FEATURE_HOP) + 1;
}

static size_t sample_of(size_t frame, uint32_t rate) {
    return (size_t)llround((double)frame * FEATURE_HOP / FEATURE_RATE * rate);
}

/* Finds the frames from the first speech to the last. False: there is none. */
static bool find_speech(const struct sound_likelihoods *heard, size_t frames, size_t *from, size_t *to) {
    size_t run = 0;
    *from = *to = 0;
    for (size_t i = 0; i < frames; i++) {
        run = heard[i].log[LIP_SILENCE] < SILENT ? run + 1 : 0;
        if (run < SPEECH_LEAST)
            continue;
        if (!*to)
            *from = i + 1 - run;
        *to = i + 1;
    }
    *from = *from > MARGIN ? *from - MARGIN : 0;
    *to = *to + MARGIN < frames ? *to + MARGIN : frames;
    return *to > MARGIN;
}

static int hear(struct judging *j, const struct align_sound *recording, const struct lip_network *network,
                struct error *e) {
    size_t frames = frames_of(recording->samples, recording->rate), from, to;
    j->all = sound_classes_hear(network, recording->pcm, recording->samples, recording->rate, frames);
    if (!j->all || !find_speech(j->all, frames, &from, &to))
        return error_set(e, ERROR_MISALIGNED, "there is no speech in the recording");
    size_t begin = sample_of(from, recording->rate), end = sample_of(to, recording->rate);
    end = end < recording->samples ? end : recording->samples;
    j->part = (struct align_sound){recording->pcm + begin, end - begin, recording->rate};
    j->before = (double)begin / recording->rate;
    j->heard = j->all + from;
    return 0;
}

/* ---- where the phones lie ---- */

/* Samples of the model before which the learner may pause: starts of words. */
static int align(struct judging *j, struct error *e) {
    const struct reference_speech *m = j->model;
    uint64_t *starts = mem_alloc((m->word_count + 1) * sizeof *starts);
    for (size_t i = 0; i < m->word_count; i++)
        starts[i] = m->words[i].start;
    const struct align_sound reference = {m->pcm, m->samples, m->rate};
    const struct align_options options = {starts, m->word_count, true, j->stop};
    int result = align_make(&j->map, &j->part, &reference, &options);
    free(starts);
    return result ? error_set(e, ERROR_MISALIGNED, "the recording is too short for the text") : 0;
}

static size_t frame_in_model(const struct judging *j, uint64_t sample) {
    return align_frame(sample, j->model->rate);
}

static size_t frame_in_part(const struct judging *j, uint64_t sample) {
    return align_frame(sample, j->part.rate);
}

/* Voices place a word's start to some samples: a phone belongs to the word that has begun by its middle. */
static uint64_t middle(const struct reference_phone *p) {
    return p->start + (p->end - p->start) / 2;
}

/* The warp's places, as a beginning for refine(). */
static void place(struct judging *j) {
    const struct reference_speech *m = j->model;
    size_t word = 0;
    bool pause = false;
    j->placed = mem_alloc((m->phone_count + 1) * sizeof *j->placed);
    j->phone_of = mem_alloc((m->phone_count + 1) * sizeof *j->phone_of);
    for (size_t i = 0; i < m->phone_count; i++) {
        const struct reference_phone *p = &m->phones[i];
        struct refine_phone *q = &j->placed[j->count];
        if (!*p->ipa) {
            pause = true;
            continue;
        }
        *q = (struct refine_phone){.pause = pause,
                                   .from = frame_in_model(j, p->start),
                                   .to = frame_in_model(j, p->end),
                                   .start = frame_in_part(j, align_time(&j->map, p->start)),
                                   .end = frame_in_part(j, align_end_time(&j->map, p->end))};
        memcpy(q->ipa, p->ipa, sizeof q->ipa);
        q->to = q->to > q->from ? q->to : q->from + 1;
        if (j->count && q->start < q[-1].end)
            q->start = q[-1].end;
        q->end = q->end > q->start ? q->end : q->start;
        for (; word < m->word_count && m->words[word].start <= middle(p); word++)
            q->word = true;
        pause = false;
        j->phone_of[j->count++] = i;
    }
}

/* ---- what is heard there ---- */

/* Mean log probabilities of each class over the frames of a phone, and of the expected ones. */
struct hearing {
    double class[LIP_CLASSES], expected;
    size_t frames;
};

static struct hearing listen(const struct judging *j, const struct refine_phone *p, const int *classes) {
    struct hearing h = {.frames = 0};
    size_t from = (size_t)lround(p->begins), to = (size_t)lround(p->ends);
    to = to > from ? to : from + 1;
    for (size_t k = from; k < to && k < j->map.recording.count; k++) {
        size_t part = (k - from) * SOUND_CLASS_PARTS / (to - from);
        for (int c = 0; c < LIP_CLASSES; c++)
            h.class[c] += (double)j->heard[k].log[c];
        h.expected += (double)j->heard[k].log[classes[part]];
        h.frames++;
    }
    for (int c = 0; c < LIP_CLASSES && h.frames; c++)
        h.class[c] /= (double)h.frames;
    if (h.frames)
        h.expected /= (double)h.frames;
    return h;
}

static void judge_phone(const struct judging *j, size_t i, struct judged_phone *out) {
    const struct refine_phone *p = &j->placed[i];
    int classes[SOUND_CLASS_PARTS];
    sound_classes_of(p->ipa, classes);
    out->state = JUDGE_UNSURE;
    if (classes[0] < 0)
        return;
    const struct hearing h = listen(j, p, classes);
    if (!h.frames)
        return;
    out->expected = (enum lip_class)classes[SOUND_CLASS_PARTS / 2];
    for (int c = LIP_SILENCE + 1; c < LIP_CLASSES; c++)
        if (h.class[c] > h.class[out->heard] || !out->heard)
            out->heard = (enum lip_class)c;
    out->score = fmin(0, h.expected - h.class[out->heard]);
    if (out->score < (double)different_below[out->expected])
        out->state = JUDGE_DIFFERENT;
    else if (out->score >= GOOD_FROM)
        out->state = JUDGE_GOOD;
}

/* ---- the judgement ---- */

static double duration_in_model(const struct judging *j, const struct judged_phone *p) {
    const struct reference_phone *m = &j->model->phones[p->phone];
    return (double)(m->end - m->start) / j->model->rate;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Durations relative to the model's, by their median. */
static double set_lengths(const struct judging *j, struct judgement *out) {
    double *ratios = mem_alloc((out->phone_count + 1) * sizeof *ratios);
    for (size_t i = 0; i < out->phone_count; i++) {
        const struct judged_phone *p = &out->phones[i];
        ratios[i] = (p->end - p->start) / fmax(duration_in_model(j, p), 1e-3);
    }
    for (size_t i = 0; i < out->phone_count; i++)
        out->phones[i].length = ratios[i];
    qsort(ratios, out->phone_count, sizeof *ratios, compare);
    double pace = out->phone_count ? ratios[out->phone_count / 2] : 1;
    for (size_t i = 0; i < out->phone_count; i++)
        out->phones[i].length /= fmax(pace, 1e-3);
    free(ratios);
    return pace;
}

static double seconds(const struct judging *j, double frame) {
    return j->before + fmax(0, frame - 0.5) * FEATURE_HOP / FEATURE_RATE;
}

static void judge_phones(const struct judging *j, struct judgement *out) {
    const struct reference_speech *m = j->model;
    double sum = 0;
    size_t word = 0;
    out->phones = mem_alloc((j->count + 1) * sizeof *out->phones);
    for (size_t i = 0; i < j->count; i++) {
        struct judged_phone *p = &out->phones[out->phone_count++];
        size_t phone = j->phone_of[i];
        while (word + 1 < m->word_count && m->words[word + 1].start <= middle(&m->phones[phone]))
            word++;
        p->phone = phone;
        p->word = m->word_count ? word : SIZE_MAX;
        p->start = seconds(j, j->placed[i].begins);
        p->end = fmax(p->start, seconds(j, j->placed[i].ends));
        judge_phone(j, i, p);
        sum += (double)j->placed[i].heard;
    }
    out->heard = j->count ? sum / (double)j->count : 0;
    out->pace = set_lengths(j, out);
}

static void judge_words(const struct judging *j, struct judgement *out) {
    out->word_count = j->model->word_count;
    out->words = mem_alloc((out->word_count + 1) * sizeof *out->words);
    for (size_t i = 0, first = 0; i < out->word_count; i++) {
        struct judged_word *w = &out->words[i];
        size_t count = 0, good = 0, different = 0, at = first;
        for (; at < out->phone_count && out->phones[at].word == i; at++, count++) {
            const struct judged_phone *p = &out->phones[at];
            good += p->state == JUDGE_GOOD;
            different += p->state == JUDGE_DIFFERENT;
            w->score += p->score;
            w->end = p->end;
        }
        w->start = count ? out->phones[first].start : i ? w[-1].end : 0;
        w->end = fmax(w->start, w->end);
        w->score /= fmax(1, (double)count);
        if (different)
            w->state = JUDGE_DIFFERENT;
        else if (count && (double)good >= GOOD_SHARE * (double)count)
            w->state = JUDGE_GOOD;
        first = at;
    }
}

static void doubt_all(struct judgement *out) {
    out->other = out->heard < UNSAID;
    for (size_t i = 0; out->other && i < out->phone_count; i++)
        out->phones[i].state = JUDGE_UNSURE;
}

static void close_judging(struct judging *j) {
    align_free(&j->map);
    free(j->all);
    free(j->placed);
    free(j->phone_of);
}

int judge(const struct align_sound *recording, const struct reference_speech *model,
          const struct lip_network *network, const atomic_bool *stop, struct judgement *result,
          struct error *e) {
    struct judging j = {.model = model, .stop = stop};
    *result = (struct judgement){0};
    int failed = hear(&j, recording, network, e) || align(&j, e) ? -1 : 0;
    if (!failed) {
        struct refine_model *speaker = refine_model_new();
        place(&j);
        if (!refine(speaker, &j.map.recording, &j.map.reference, j.heard, j.placed, j.count, stop))
            failed = error_plain(e, ERROR_CANCELLED);
        refine_model_free(speaker);
    }
    if (!failed) {
        judge_phones(&j, result);
        doubt_all(result);
        judge_words(&j, result);
    }
    close_judging(&j);
    return failed ? -1 : 0;
}

void judgement_free(struct judgement *j) {
    free(j->phones);
    free(j->words);
    *j = (struct judgement){0};
}
