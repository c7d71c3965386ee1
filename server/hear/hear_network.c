/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/hear/hear_network.h"
#include "server/base/mem.h"
#include "server/hear/hear_network_internal.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How much of the way to what is new the running means go in a frame; at first
 * more. */
#define VOICE_PACE 0.04F

struct hear_state {
    const struct hear_network *network;
    float *frames;              /* the convolution's last inputs, oldest first */
    float *middle;              /* what it gives */
    float *memory[HEAR_LAYERS]; /* of the recurrent layers */
    float *mean, *off;          /* of the last layer's memory of late, and how far it lies from that */
    float heard;                /* frames, as far as they count */
    float *gates, *recurrent;   /* of the step: from the input, from the memory */
};

struct hear_state *hear_state_new(const struct hear_network *n) {
    struct hear_state *s = mem_alloc(sizeof *s);
    s->network = n;
    s->frames = mem_alloc(n->taps * HEAR_FEATURES * sizeof *s->frames);
    s->middle = mem_alloc(n->middle * sizeof *s->middle);
    for (int i = 0; i < HEAR_LAYERS; i++)
        s->memory[i] = mem_alloc(n->size * sizeof **s->memory);
    s->mean = mem_alloc(n->size * sizeof *s->mean);
    s->off = mem_alloc(n->size * sizeof *s->off);
    s->gates = mem_alloc(3 * n->size * sizeof *s->gates);
    s->recurrent = mem_alloc(3 * n->size * sizeof *s->recurrent);
    return s;
}

void hear_state_free(struct hear_state *s) {
    if (!s)
        return;
    free(s->frames);
    free(s->middle);
    for (int i = 0; i < HEAR_LAYERS; i++)
        free(s->memory[i]);
    free(s->mean);
    free(s->off);
    free(s->gates);
    free(s->recurrent);
    free(s);
}

/* Four sums at a time, which the compiler can keep in one register. */
static float product(const float *a, const float *b, size_t count) {
    float sum[4] = {0}, rest = 0;
    size_t i = 0;
    for (; i + 4 <= count; i += 4)
        for (int k = 0; k < 4; k++)
            sum[k] += a[i + (size_t)k] * b[i + (size_t)k];
    for (; i < count; i++)
        rest += a[i] * b[i];
    return sum[0] + sum[1] + (sum[2] + sum[3]) + rest;
}

static void affine(const struct hear_affine *a, const float *in, float *out) {
    for (size_t i = 0; i < a->outputs; i++)
        out[i] = a->bias[i] + product(a->weight + i * a->inputs, in, a->inputs);
}

static float sigmoid(float x) {
    return 1 / (1 + expf(-x));
}

/* Gates in the order reset, update, new. */
static void recur(struct hear_state *s, int layer, const float *in) {
    size_t size = s->network->size;
    float *h = s->memory[layer];
    affine(&s->network->input[layer], in, s->gates);
    affine(&s->network->hidden[layer], h, s->recurrent);
    for (size_t i = 0; i < size; i++) {
        float reset = sigmoid(s->gates[i] + s->recurrent[i]);
        float update = sigmoid(s->gates[size + i] + s->recurrent[size + i]);
        float fresh = tanhf(s->gates[2 * size + i] + reset * s->recurrent[2 * size + i]);
        h[i] = (1 - update) * fresh + update * h[i];
    }
}

static void softmax(float x[HEAR_CLASSES]) {
    float most = x[0], sum = 0;
    for (int i = 1; i < HEAR_CLASSES; i++)
        most = fmaxf(most, x[i]);
    for (int i = 0; i < HEAR_CLASSES; i++)
        sum += x[i] = expf(x[i] - most);
    for (int i = 0; i < HEAR_CLASSES; i++)
        x[i] /= sum;
}

static float voice(struct hear_state *s) {
    const struct hear_network *n = s->network;
    const float *h = s->memory[HEAR_LAYERS - 1];
    float pace = fmaxf(VOICE_PACE, 1 / ++s->heard);
    for (size_t i = 0; i < n->size; i++) {
        s->mean[i] += pace * (h[i] - s->mean[i]);
        s->off[i] += pace * (fabsf(h[i] - s->mean[i]) - s->off[i]);
    }
    return *n->voice_bias + product(n->voice, h, n->size) + product(n->voice + n->size, s->mean, n->size) +
           product(n->voice + 2 * n->size, s->off, n->size);
}

void hear_state_step(struct hear_state *s, const float frame[HEAR_FEATURES], size_t head,
                     struct hear_answer *answer) {
    const struct hear_network *n = s->network;
    size_t before = (n->taps - 1) * HEAR_FEATURES;
    memmove(s->frames, s->frames + HEAR_FEATURES, before * sizeof *s->frames);
    memcpy(s->frames + before, frame, HEAR_FEATURES * sizeof *frame);
    affine(&n->conv, s->frames, s->middle);
    for (size_t i = 0; i < n->middle; i++)
        s->middle[i] = fmaxf(0, s->middle[i]);
    recur(s, 0, s->middle);
    recur(s, 1, s->memory[0]);
    affine(&n->heads[head], s->memory[1], answer->likely);
    softmax(answer->likely);
    affine(&n->mouths[head], s->memory[1], answer->mouth);
    answer->voice = voice(s);
}
