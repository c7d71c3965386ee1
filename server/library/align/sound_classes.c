/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/align/sound_classes.h"
#include "server/base/mem.h"
#include "server/library/align/mfcc.h"
#include "server/live/lip_features.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As models/tools/hear/sounds.py groups them. */
static const char *const class_letters[LIP_CLASSES] = {
    [LIP_SILENCE] = "",       [LIP_CLOSED] = "pbmɓ",        [LIP_TEETH] = "fvɱʋ",
    [LIP_ROUNDED] = "ʃʒɕʑʂʐ", [LIP_DENTAL] = "θð",          [LIP_HISS] = "sz",
    [LIP_TIP] = "tdnɳɲʈɖ",    [LIP_LIQUID] = "lrɹɾɻʎɭɫʀɬɽ", [LIP_BACK] = "kɡgŋxɣhɦχʁqcɟʔɢħʝɰ",
    [LIP_OPEN] = "aɑæʌɐɶɒ",   [LIP_MIDDLE] = "eɛəɜɚɝɤɘᵻ",   [LIP_MIDDLE_ROUND] = "oɔøœɵ",
    [LIP_CLOSE] = "iɪjɨɯ",    [LIP_CLOSE_ROUND] = "uʊywɥʏʉ"};

enum { LETTERS_MOST = 16, LETTER_BYTES = 4 };

static int class_of(const char *letter) {
    for (int class = 1; class < LIP_CLASSES; class ++)
        if (strstr(class_letters[class], letter))
            return class;
    return -1;
}

void sound_classes_of(const char *ipa, int classes[SOUND_CLASS_PARTS]) {
    int found[LETTERS_MOST], count = 0;
    bool vowel = false;
    while (*ipa && count < LETTERS_MOST) {
        char letter[LETTER_BYTES + 1] = {*ipa++};
        for (size_t i = 1; (*ipa & 0xC0) == 0x80; ipa++)
            if (i < LETTER_BYTES)
                letter[i++] = *ipa;
        int class = class_of(letter);
        if (class >= 0)
            found[count++] = class;
        vowel = vowel || class >= LIP_OPEN;
    }
    for (int part = 0; part < SOUND_CLASS_PARTS; part++)
        classes[part] = !count ? -1 : vowel ? found[part * count / SOUND_CLASS_PARTS] : found[count - 1];
}

/* Least probability of a class: the network is never that sure. */
#define LEAST 0.01F

struct hearing {
    struct lip_state *state;
    size_t head, delay, steps; /* the network answers for so many frames ago */
    struct sound_likelihoods *heard;
    size_t cap;
};

static void take_frame(void *ctx, const float frame[LIP_FEATURES]) {
    struct hearing *h = ctx;
    struct lip_answer answer;
    lip_state_step(h->state, frame, h->head, &answer);
    if (h->steps++ < h->delay)
        return;
    size_t k = h->steps - 1 - h->delay;
    h->heard = mem_grow(h->heard, &h->cap, k + 1, sizeof *h->heard);
    for (int c = 0; c < LIP_CLASSES; c++)
        h->heard[k].log[c] = logf(answer.likely[c] + LEAST);
}

static void take_sound(void *ctx, const float *samples, size_t count) {
    lip_features_write(ctx, samples, count);
}

/* Hears the sound, and silence after it for as long as the network looks ahead. */
static void hear(struct lip_input *input, const int16_t *pcm, size_t samples, size_t silence) {
    enum { BLOCK = 1024 };
    float block[BLOCK];
    for (size_t at = 0; at < samples + silence;) {
        size_t count = 0;
        for (; count < BLOCK && at < samples + silence; at++)
            block[count++] = at < samples ? (float)pcm[at] / 32768 : 0;
        lip_input_write(input, block, count);
    }
    lip_input_end(input);
}

/* The network's frames are centred on the middle of their window, those of mfcc.h on their beginning. */
static void interpolate(const struct hearing *h, size_t count, struct sound_likelihoods *out, size_t frames) {
    for (size_t i = 0; i < frames; i++) {
        double at = fmax(0, ((double)i * FEATURE_HOP - LIP_WINDOW / 2) / LIP_HOP);
        size_t k = at < (double)(count - 1) ? (size_t)at : count - 1, next = k + 1 < count ? k + 1 : k;
        float share = k < next ? (float)(at - (double)k) : 0;
        for (int c = 0; c < LIP_CLASSES; c++)
            out[i].log[c] = h->heard[k].log[c] * (1 - share) + h->heard[next].log[c] * share;
    }
}

struct sound_likelihoods *sound_classes_hear(const struct lip_network *network, const int16_t *pcm,
                                             size_t samples, uint32_t rate, size_t frames) {
    unsigned delays[LIP_HEADS_MOST];
    struct error e;
    struct hearing h = {.state = lip_state_new(network), .head = lip_network_delays(network, delays) - 1};
    struct lip_features *features = lip_features_new(take_frame, &h);
    struct lip_input *input = lip_input_new(rate, 1, take_sound, features, &e);
    struct sound_likelihoods *out = NULL;
    h.delay = delays[h.head];
    if (input)
        hear(input, pcm, samples, (size_t)rate * (h.delay + 5) * LIP_HOP / LIP_RATE);
    if (h.steps > h.delay) {
        out = mem_alloc(frames * sizeof *out);
        interpolate(&h, h.steps - h.delay, out, frames);
    }
    free(h.heard);
    lip_state_free(h.state);
    lip_features_free(features);
    lip_input_free(input);
    return out;
}
